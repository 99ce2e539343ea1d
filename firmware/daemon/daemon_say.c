#include "firmware/daemon/daemon.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

void iso_daemon_say(int priority, const char *text)
{
    char line[1024];
    if (!getenv("JOURNAL_STREAM")) {
        fprintf(stderr, "isothermd: %s\n", text);
        return;
    }
    const int written = snprintf(line, sizeof line, "<%d>%s\n", priority, text);
    const size_t length = (size_t)written < sizeof line ? (size_t)written : sizeof line - 1;
    line[length - 1] = '\n'; /* a text that was cut needs it, too */
    if (send(STDERR_FILENO, line, length, MSG_DONTWAIT | MSG_NOSIGNAL) < 0 && errno == ENOTSOCK) {
        (void)!write(STDERR_FILENO, line, length);
    }
}
