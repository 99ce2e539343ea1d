/* Loaded into the daemon: every fsync and fdatasync takes SLOW_SYNC_MS milliseconds longer. */
#include <dlfcn.h>
#include <stdlib.h>
#include <time.h>

static int delay(const char *name, int fd)
{
    int (*real)(int) = NULL;
    const char *text = getenv("SLOW_SYNC_MS");
    const long ms = text ? strtol(text, NULL, 10) : 0;
    const struct timespec wait = {ms / 1000, ms % 1000 * 1000000L};
    *(void **)&real = dlsym(RTLD_NEXT, name);
    (void)nanosleep(&wait, NULL);
    return real(fd);
}

int fsync(int fd)
{
    return delay("fsync", fd);
}

int fdatasync(int fd)
{
    return delay("fdatasync", fd);
}
