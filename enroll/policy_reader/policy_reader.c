/* isotherm-policy-reader FORMAT [ZONE]: reads a file of a policy from standard input and prints it
 * as JSON. `isotherm policy import` runs it, because the file may come from somebody else, and the
 * libraries that read it are large. FORMAT is json, toml or ics; ZONE is the time zone of times of
 * a calendar without one.
 *
 * The program gives up everything but its three descriptors before it reads (confine.h). Exit
 * status: 0; 1 and one line on standard error if the file is refused; 2 for a wrong call; 3 if the
 * process cannot be confined. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "enroll/policy_reader/confine.h"
#include "enroll/policy_reader/reader_input.h"

enum { INPUT_MAX_BYTES = 1 << 20 };

/* Reads standard input to its end. Returns the bytes with a zero byte after them, or NULL. */
static char *read_all(size_t *size, struct reader_line *line)
{
    char *bytes = malloc(INPUT_MAX_BYTES + 2);
    ssize_t n = 1;
    *size = 0;
    while (bytes && n > 0 && *size <= INPUT_MAX_BYTES) {
        n = read(STDIN_FILENO, bytes + *size, INPUT_MAX_BYTES + 1 - *size);
        n = n < 0 && errno == EINTR ? 1 : n;
        *size += n > 0 ? (size_t)n : 0;
    }
    if (!bytes || n < 0 || *size > INPUT_MAX_BYTES) {
        (void)reader_refuse(line, "%s",
                            !bytes  ? "there is no memory"
                            : n < 0 ? strerror(errno)
                                    : "the file has more than 1 MiB");
        free(bytes);
        return NULL;
    }
    bytes[*size] = '\0';
    return bytes;
}

/* libical writes messages of its own to standard error. Returns the descriptor for the one line of
 * this program, and leads standard error to nowhere; -1 if that fails. */
static int silence(void)
{
    const int line_fd = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
    return line_fd >= 0 && freopen("/dev/null", "w", stderr) ? line_fd : -1;
}

static int today(void)
{
    const time_t now = time(NULL);
    struct tm utc;
    return gmtime_r(&now, &utc)
               ? (utc.tm_year + 1900) * 10000 + (utc.tm_mon + 1) * 100 + utc.tm_mday
               : 0;
}

static json_t *read_format(const char *format, const char *zone, const char *bytes, size_t size,
                           struct reader_line *line)
{
    if (memchr(bytes, '\0', size)) {
        return reader_refuse(line, "the file has a zero byte: it is no text");
    }
    if (strcmp(format, "json") == 0) {
        return reader_json(bytes, size, line);
    }
    return strcmp(format, "toml") == 0 ? reader_toml(bytes, size, line)
                                       : reader_ics(bytes, size, zone, today(), line);
}

int main(int argc, char **argv)
{
    const char *format = argc == 2 || argc == 3 ? argv[1] : "";
    if (strcmp(format, "json") != 0 && strcmp(format, "toml") != 0 && strcmp(format, "ics") != 0) {
        (void)fputs("usage: isotherm-policy-reader json|toml|ics [ZONE] <FILE\n", stderr);
        return 2;
    }
    const int line_fd = silence();
    const int error = line_fd < 0 ? -errno : reader_confine();
    if (error != 0) {
        (void)dprintf(line_fd < 0 ? STDERR_FILENO : line_fd, "the reader cannot be confined: %s\n",
                      strerror(-error));
        return 3;
    }
    struct reader_line line = {.text = ""};
    size_t size = 0;
    char *bytes = read_all(&size, &line);
    json_t *document = bytes ? read_format(format, argc == 3 ? argv[2] : NULL, bytes, size, &line)
                             : NULL;
    char *text = document ? json_dumps(document, JSON_COMPACT) : NULL;
    json_decref(document);
    free(bytes);
    if (!text) {
        (void)dprintf(line_fd, "%s\n", line.text[0] ? line.text : "there is no memory");
        return 1;
    }
    const int failed = fputs(text, stdout) < 0 || fflush(stdout) != 0;
    free(text);
    return failed ? 1 : 0;
}
