/* Finds out by inotify which files in a directory a program opens. */
#ifndef TESTS_FIRMWARE_DAEMON_OPENED_FILES_H
#define TESTS_FIRMWARE_DAEMON_OPENED_FILES_H

#include <stddef.h>

enum { NAMES_MAX = 64, NAME_SIZE = 128 };

struct names {
    size_t n;
    char text[NAMES_MAX][NAME_SIZE]; /* path below the directory */
};

/* Adds FOLDER/NAME, unless the list has it already. */
void names_add(struct names *names, const char *folder, const char *name);

/* The watched folders: the directory itself (""), "slot", "slot/depth", and "credentials". */
enum { FOLDERS = 4 };

/* Begins to watch. Returns the descriptor for opened_files_collect. */
int opened_files_watch(const char *directory, int watches[FOLDERS]);

/* Adds the files that were opened since the last call. */
void opened_files_collect(int fd, const int watches[FOLDERS], struct names *names);

#endif
