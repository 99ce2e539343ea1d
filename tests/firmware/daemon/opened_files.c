#include "tests/firmware/daemon/opened_files.h"

#include <stdio.h>
#include <string.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/support/scratch.h"

static const char *const folders[FOLDERS] = {"", "slot", "slot/depth", "credentials"};

void names_add(struct names *names, const char *folder, const char *name)
{
    char text[NAME_SIZE];
    (void)snprintf(text, sizeof text, "%s%s%.90s", folder, *folder ? "/" : "", name);
    for (size_t i = 0; i < names->n; i++) {
        if (strcmp(names->text[i], text) == 0) {
            return;
        }
    }
    assert_true(names->n < NAMES_MAX);
    memcpy(names->text[names->n++], text, sizeof text);
}

int opened_files_watch(const char *directory, int watches[FOLDERS])
{
    const int fd = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    assert_true(fd >= 0);
    for (size_t i = 0; i < FOLDERS; i++) {
        watches[i] = inotify_add_watch(fd, scratch_path(directory, folders[i]), IN_OPEN);
        assert_true(watches[i] >= 0);
    }
    return fd;
}

void opened_files_collect(int fd, const int watches[FOLDERS], struct names *names)
{
    _Alignas(struct inotify_event) char buffer[65536];
    ssize_t size;
    while ((size = read(fd, buffer, sizeof buffer)) > 0) {
        for (char *at = buffer; at < buffer + size;) {
            const struct inotify_event *event = (const struct inotify_event *)at;
            for (size_t i = 0; i < FOLDERS; i++) {
                if (event->wd == watches[i] && event->len > 0 && !(event->mask & IN_ISDIR)) {
                    names_add(names, folders[i], event->name);
                }
            }
            at += sizeof *event + event->len;
        }
    }
}
