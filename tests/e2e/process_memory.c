#include "tests/e2e/process_memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static FILE *open_of(pid_t pid, const char *name)
{
    char path[64];
    (void)snprintf(path, sizeof path, "/proc/%d/%s", (int)pid, name);
    return fopen(path, "re");
}

/* Whether a line of maps describes an area that the process may read and write. */
static bool is_own(const char *line, unsigned long *from, unsigned long *to)
{
    char rights[5] = "";
    return sscanf(line, "%lx-%lx %4s", from, to, rights) == 3 && rights[0] == 'r' &&
           rights[1] == 'w';
}

static void append(struct process_memory *memory, int fd, unsigned long from, unsigned long to)
{
    unsigned char *bytes = realloc(memory->bytes, memory->size + (to - from));
    assert_non_null(bytes);
    memory->bytes = bytes;
    for (unsigned long at = from; at < to;) {
        const ssize_t n = pread(fd, bytes + memory->size, to - at, (off_t)at);
        if (n <= 0) {
            break; /* a page that was never used */
        }
        memory->size += (size_t)n;
        at += (unsigned long)n;
    }
}

static void read_areas(FILE *maps, FILE *mem, struct process_memory *out)
{
    char line[1024];
    unsigned long from, to;
    while (fgets(line, sizeof line, maps)) {
        if (is_own(line, &from, &to)) {
            append(out, fileno(mem), from, to);
        }
    }
}

bool process_memory_read(pid_t pid, struct process_memory *out)
{
    *out = (struct process_memory){NULL, 0};
    FILE *maps = open_of(pid, "maps");
    FILE *mem = maps ? open_of(pid, "mem") : NULL;
    if (!mem) {
        assert_true(errno == EACCES || errno == EPERM);
        if (maps) {
            fclose(maps);
        }
        return false;
    }
    int status = 0;
    assert_int_equal(kill(pid, SIGSTOP), 0);
    assert_int_equal(waitpid(pid, &status, WUNTRACED), pid);
    assert_true(WIFSTOPPED(status));
    read_areas(maps, mem, out);
    assert_int_equal(kill(pid, SIGCONT), 0);
    fclose(maps);
    fclose(mem);
    assert_true(out->size > 1 << 20);
    return true;
}

void process_memory_free(struct process_memory *memory)
{
    free(memory->bytes);
    *memory = (struct process_memory){NULL, 0};
}

int process_memory_count(const struct process_memory *memory, const void *bytes, size_t size)
{
    int n = 0;
    const unsigned char *at = memory->bytes, *end = memory->bytes + memory->size;
    while ((at = memmem(at, (size_t)(end - at), bytes, size))) {
        n++;
        at += size;
    }
    return n;
}
