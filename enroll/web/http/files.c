#include "enroll/web/http/files.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "drivers/file/file.h"
#include "enroll/web/http/answer.h"

static const struct {
    const char *ending, *type;
} types[] = {
    {".html", "text/html; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".mjs", "text/javascript; charset=utf-8"},
    {".json", "application/json"},
    {".webmanifest", "application/manifest+json"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".ico", "image/vnd.microsoft.icon"},
    {".woff2", "font/woff2"},
    {".mo", "application/octet-stream"},
    {".txt", "text/plain; charset=utf-8"},
};

/* NULL: files of this name are not served. */
static const char *type_of(const char *name)
{
    const char *ending = strrchr(name, '.');

    for (size_t i = 0; ending && i < sizeof types / sizeof *types; i++) {
        if (strcmp(ending, types[i].ending) == 0) {
            return types[i].type;
        }
    }
    return NULL;
}

static void make_etag(const char *bytes, size_t size, char etag[WEB_FILE_ETAG_SIZE])
{
    uint8_t hash[16];

    crypto_generichash(hash, sizeof hash, (const unsigned char *)bytes, size, NULL, 0);
    etag[0] = '"';
    sodium_bin2hex(etag + 1, WEB_FILE_ETAG_SIZE - 1, hash, sizeof hash);
    etag[WEB_FILE_ETAG_SIZE - 2] = '"';
    etag[WEB_FILE_ETAG_SIZE - 1] = '\0';
}

static bool complete(struct MHD_Response *response, const char *type, const char *etag)
{
    return response && web__answer_add_headers(response, type, "no-cache") &&
           MHD_add_response_header(response, "ETag", etag) == MHD_YES;
}

/* Takes `bytes` over. */
static int make_responses(struct web_file *file, char *bytes, size_t size, const char *type)
{
    make_etag(bytes, size, file->etag);
    file->whole = MHD_create_response_from_buffer(size, bytes, MHD_RESPMEM_MUST_FREE);
    if (!file->whole) {
        free(bytes);
        return -ENOMEM;
    }
    file->unchanged = MHD_create_response_from_buffer(0, NULL, MHD_RESPMEM_PERSISTENT);
    return complete(file->whole, type, file->etag) && complete(file->unchanged, NULL, file->etag)
               ? 0
               : -ENOMEM;
}

static int read_one(struct web_files *files, const char *folder, const char *name,
                    struct iso_fault *fault)
{
    char path[PATH_MAX], *bytes = NULL;
    size_t size = 0;
    int r;

    if (files->n == WEB_FILES_MOST) {
        return iso_fault_set(fault, -E2BIG, "%s: has more than %d files", folder, WEB_FILES_MOST);
    }
    struct web_file *file = &files->items[files->n];
    if (snprintf(path, sizeof path, "%s%s", folder, name) >= (int)sizeof path ||
        strlen(name) >= sizeof file->path) {
        return iso_file_fault(name, -ENAMETOOLONG, fault);
    }
    r = iso_file_read(path, WEB_FILE_MOST_BYTES, &bytes, &size, fault);
    if (r < 0) {
        return r;
    }
    *file = (struct web_file){0};
    strcpy(file->path, name);
    files->n++;
    r = make_responses(file, bytes, size, type_of(name));
    return r < 0 ? iso_fault_set(fault, r, "%s: out of memory", path) : 0;
}

static int read_folder(struct web_files *files, const char *folder, const char *below,
                       struct iso_fault *fault);

/* How many folders a path such as "/js/base/dom.js" has. */
static int depth_of(const char *path)
{
    int n = -1;

    for (; *path; path++) {
        n += *path == '/';
    }
    return n;
}

static int read_entry(struct web_files *files, const char *folder, const char *below,
                      const char *name, struct iso_fault *fault)
{
    char path[PATH_MAX], inner[WEB_FILE_PATH_SIZE];
    struct stat s;

    if (name[0] == '.') {
        return 0;
    }
    if (snprintf(inner, sizeof inner, "%s/%s", below, name) >= (int)sizeof inner ||
        snprintf(path, sizeof path, "%s%s", folder, inner) >= (int)sizeof path) {
        return iso_file_fault(name, -ENAMETOOLONG, fault);
    }
    if (stat(path, &s)) {
        return iso_file_fault(path, -errno, fault);
    }
    if (S_ISDIR(s.st_mode)) {
        return depth_of(inner) < WEB_FOLDERS_DEEP
                   ? read_folder(files, folder, inner, fault)
                   : iso_fault_set(fault, -EINVAL, "%s: is a folder too deep in the pages", path);
    }
    return type_of(name) ? read_one(files, folder, inner, fault) : 0;
}

/* Reads the files of `folder``below`, where `below` is "", "/js" or "/js/base". */
static int read_folder(struct web_files *files, const char *folder, const char *below,
                       struct iso_fault *fault)
{
    char path[PATH_MAX];
    const struct dirent *entry;
    int r = 0;

    if (snprintf(path, sizeof path, "%s%s", folder, below) >= (int)sizeof path) {
        return iso_file_fault(folder, -ENAMETOOLONG, fault);
    }
    DIR *directory = opendir(path);
    if (!directory) {
        return iso_file_fault(path, -errno, fault);
    }
    while (r == 0 && (entry = readdir(directory))) {
        r = read_entry(files, folder, below, entry->d_name, fault);
    }
    closedir(directory);
    return r;
}

int web__files_read(struct web_files *files, const char *folder, struct iso_fault *fault)
{
    const int r = read_folder(files, folder, "", fault);

    if (r < 0) {
        return r;
    }
    return web__files_find(files, "/") ? 0
                                       : iso_fault_set_code(fault, ISO_FAULT_FILE_MISSING, -ENOENT,
                                                            "%s: has no index.html", folder);
}

void web__files_free(struct web_files *files)
{
    for (size_t i = 0; i < files->n; i++) {
        if (files->items[i].whole) {
            MHD_destroy_response(files->items[i].whole);
        }
        if (files->items[i].unchanged) {
            MHD_destroy_response(files->items[i].unchanged);
        }
    }
    files->n = 0;
}

const struct web_file *web__files_find(const struct web_files *files, const char *path)
{
    const char *wanted = strcmp(path, "/") == 0 ? "/index.html" : path;

    for (size_t i = 0; i < files->n; i++) {
        if (strcmp(files->items[i].path, wanted) == 0) {
            return &files->items[i];
        }
    }
    return NULL;
}

bool web__file_is_unchanged(const struct web_file *file, const char *if_none_match)
{
    const char *tag = if_none_match ? if_none_match : "";

    for (tag += strspn(tag, ", \t"); *tag; tag += strspn(tag, ", \t")) {
        const size_t n = strcspn(tag, ", \t");
        const size_t weak = strncmp(tag, "W/", 2) == 0 ? 2 : 0;
        if ((n == 1 && *tag == '*') ||
            (n - weak == strlen(file->etag) && strncmp(tag + weak, file->etag, n - weak) == 0)) {
            return true;
        }
        tag += n;
    }
    return false;
}
