#include "firmware/contract/login_users.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/base/utf8.h"
#include "drivers/file/file.h"
#include "drivers/file/text.h"

enum { FILE_MAX_BYTES = 64 << 10 };

/* ---- a line ---- */

struct row {
    const char *user, *person;
};

static bool is_user(const char *user)
{
    for (const char *c = user; *c; c++) {
        if (*c <= ' ' || *c > '~' || *c == ':' || *c == '/') {
            return false;
        }
    }
    return *user && strlen(user) <= ISO_LOGIN_USER_BYTES;
}

/* The daemon knows all rules for names. These two keep out what could forge a line of the log. */
static bool is_person(const char *person)
{
    uint32_t c = 0;
    for (const char *at = person; *at;) {
        const int length = iso_utf8_decode(at, &c);
        if (!length || c < 0x20 || (c >= 0x7f && c < 0xa0)) {
            return false;
        }
        at += length;
    }
    return *person && strlen(person) < ISO_PERSON_NAME_SIZE && *person != ' ' && c != ' ';
}

/* Cuts a line at its first blank. Returns NULL, or what is wrong with the line. */
static const char *parse_row(char *line, struct row *row)
{
    char *blank = strchr(line, ' ');
    if (!blank) {
        return "not `USER PERSON`";
    }
    *blank = '\0';
    *row = (struct row){.user = line, .person = blank + 1};
    if (!is_user(row->user)) {
        return "the name of the user is empty, too long, or has a character that no user has";
    }
    return is_person(row->person)
               ? NULL
               : "the name of the person is empty, too long, not UTF-8, or has a "
                 "control character or a blank at an end";
}

/* ---- the text ---- */

/* Handles one line. Returns NULL, or what is wrong with it. */
static const char *take_line(char *line, const char *user, const char **person)
{
    struct row row;
    const char *what = parse_row(line, &row);
    if (what || strcmp(row.user, user) != 0) {
        return what;
    }
    if (*person) {
        return "this user has an earlier line";
    }
    *person = row.person;
    return NULL;
}

int iso_login_users_parse(const char *name, char *text, size_t size, const char *user,
                          char person[ISO_PERSON_NAME_SIZE], struct iso_fault *fault)
{
    const char *found = NULL;
    if (memchr(text, '\0', size)) {
        return iso_fault_set(fault, -EBADMSG, "%s: contains a NUL byte", name);
    }
    struct iso_text_lines lines = iso_text_lines_of(text);
    for (char *line; (line = iso_text_next_line(&lines));) {
        const char *what = *line && *line != '#' ? take_line(line, user, &found) : NULL;
        if (what) {
            return iso_fault_set(fault, -EBADMSG, "%s:%u: %s", name, lines.number, what);
        }
    }
    if (!found) {
        return iso_fault_set(fault, -ESRCH, "%s: no person belongs to this user", name);
    }
    (void)snprintf(person, ISO_PERSON_NAME_SIZE, "%s", found);
    return 0;
}

/* ---- the file ---- */

static int check_owner(const char *path, int fd, uid_t owner, struct iso_fault *fault)
{
    struct stat status;
    if (fstat(fd, &status)) {
        return iso_file_fault(path, -errno, fault);
    }
    if (status.st_uid != owner) {
        return iso_fault_set(fault, -EPERM, "%s: belongs to user %u, not to user %u", path,
                             (unsigned)status.st_uid, (unsigned)owner);
    }
    if (status.st_mode & (S_IWGRP | S_IWOTH)) {
        return iso_fault_set(fault, -EPERM, "%s: others than its owner may write it", path);
    }
    return 0;
}

/* Reads the file to its end, or one byte more than it may have. */
static int read_all(const char *path, int fd, char *text, size_t *size, struct iso_fault *fault)
{
    ssize_t n;
    *size = 0;
    do {
        n = read(fd, text + *size, FILE_MAX_BYTES + 1 - *size);
        *size += n > 0 ? (size_t)n : 0;
    } while (n > 0 || (n < 0 && errno == EINTR));
    if (n < 0) {
        return iso_file_fault(path, -errno, fault);
    }
    text[*size] = '\0';
    return *size > FILE_MAX_BYTES ? iso_fault_set(fault, -EFBIG, "%s: is too long", path) : 0;
}

int iso_login_users_find(const char *path, uid_t owner, const char *user,
                         char person[ISO_PERSON_NAME_SIZE], struct iso_fault *fault)
{
    int fd = -1;
    size_t size = 0;
    int error = iso_file_open(path, O_RDONLY, FILE_MAX_BYTES, &fd, fault);
    if (error) {
        return error;
    }
    char *text = malloc(FILE_MAX_BYTES + 2);
    if (!text) {
        (void)close(fd);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    error = check_owner(path, fd, owner, fault);
    if (!error) {
        error = read_all(path, fd, text, &size, fault);
    }
    if (!error) {
        error = iso_login_users_parse(path, text, size, user, person, fault);
    }
    free(text);
    (void)close(fd);
    return error;
}
