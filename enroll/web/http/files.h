/* The files of the pages, kept in memory. Internal to enroll/web/http.
 *
 * The folder and its subfolders, two levels deep, are listed once; a deeper one is an error. Only
 * files are served whose name has an ending that a browser needs; names that begin with a point are
 * left out. */
#ifndef WEB_HTTP_FILES_H
#define WEB_HTTP_FILES_H

#include <microhttpd.h>
#include <stddef.h>

#include "core/base/fault.h"

enum {
    WEB_FOLDERS_DEEP = 2,
    WEB_FILES_MOST = 256,
    WEB_FILE_MOST_BYTES = 1 << 20,
    WEB_FILE_PATH_SIZE = 128, /* "/js/door.js", with the NUL */
    WEB_FILE_ETAG_SIZE = 35,  /* 32 digits in quotation marks, with the NUL */
};

struct web_file {
    char path[WEB_FILE_PATH_SIZE];
    char etag[WEB_FILE_ETAG_SIZE];
    struct MHD_Response *whole, *unchanged; /* 200 and 304 */
};

struct web_files {
    size_t n;
    struct web_file items[WEB_FILES_MOST];
};

/* Reads the folder. 0; or a negative errno with a fault: -E2BIG there are too many files, -EINVAL
 * a folder is too deep, -ENOENT there is no index.html, and the errors of opendir() and
 * iso_file_read. web__files_free frees what was read, also after an error. */
int web__files_read(struct web_files *files, const char *folder, struct iso_fault *fault)
    __attribute__((warn_unused_result));

void web__files_free(struct web_files *files);

/* The file of a path that is percent-decoded; "/" is "/index.html". NULL: there is none. */
const struct web_file *web__files_find(const struct web_files *files, const char *path);

/* Whether the header "If-None-Match" (NULL: there is none) names the present content. */
bool web__file_is_unchanged(const struct web_file *file, const char *if_none_match);

#endif
