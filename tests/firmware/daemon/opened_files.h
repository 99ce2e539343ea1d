/* Which files a program opens in a directory, as the kernel (inotify) tells. */
#ifndef TESTS_FIRMWARE_DAEMON_OPENED_FILES_H
#define TESTS_FIRMWARE_DAEMON_OPENED_FILES_H

#include <stddef.h>

enum { NAMES_MAX = 64, NAME_SIZE = 128 };

struct names {
    size_t n;
    char text[NAMES_MAX][NAME_SIZE]; /* below the directory */
};

/* Adds FOLDER/NAME, if it is new. */
void names_add(struct names *names, const char *folder, const char *name);

/* The directory, and the folders in it that are watched: "", "slot", "slot/depth", "credentials".
 */
enum { FOLDERS = 4 };

/* Begins to watch; the descriptor, for opened_files_collect. */
int opened_files_watch(const char *directory, int watches[FOLDERS]);
void opened_files_collect(int fd, const int watches[FOLDERS], struct names *names);

#endif
