#include "drivers/base/module.h"

#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; /* protects all slots */

/* ---- the path of a module ---- */

int iso_module_path(const char *name, char path[PATH_MAX], struct iso_fault *fault)
{
    Dl_info library;
    char own[PATH_MAX];
    /* Any function of libisotherm-core.so tells where the library is. */
    if (!dladdr((const void *)(uintptr_t)iso_fault_set, &library) ||
        !realpath(library.dli_fname, own)) {
        return iso_fault_set(fault, -ENOENT, "the module %s: the library's own folder is not known",
                             name);
    }
    const int folder = (int)(strrchr(own, '/') - own);
    const int length = snprintf(path, PATH_MAX, "%.*s/isotherm-%s.so", folder, own, name);
    return length < PATH_MAX
               ? 0
               : iso_fault_set(fault, -ENAMETOOLONG, "the module %s: path too long", name);
}

/* ---- whether it can be used ---- */

static int check_file(const char *path, const char *name, struct iso_fault *fault)
{
    struct stat file;
    if (lstat(path, &file)) {
        return errno == ENOENT || errno == ENOTDIR
                   ? iso_fault_set_code(fault, ISO_FAULT_MODULE_MISSING, -ENOENT,
                                        "the module %s is missing: install the package isotherm-%s",
                                        path, name)
                   : iso_fault_set_code(fault, ISO_FAULT_MODULE_UNFIT, -EBADMSG,
                                        "the module %s: %s", path, strerror(errno));
    }
    if (!S_ISREG(file.st_mode)) {
        return iso_fault_set_code(fault, ISO_FAULT_MODULE_UNFIT, -EBADMSG,
                                  "the module %s is not a regular file", path);
    }
    if (file.st_mode & S_IWOTH) {
        return iso_fault_set_code(fault, ISO_FAULT_MODULE_UNFIT, -EBADMSG,
                                  "the module %s may be written by anybody", path);
    }
    return 0;
}

/* RTLD_NOW resolves all symbols at once, because nothing can be loaded later, when the process is
 * confined. A module is never closed, because C++ libraries leave threads and destructors
 * behind. */
static void *open_file(const char *path, struct iso_fault *fault)
{
    void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!handle) {
        const char *why = dlerror();
        const size_t length = strlen(path);
        if (!why) {
            why = "no reason is known";
        }
        why = strncmp(why, path, length) == 0 && why[length] == ':' ? why + length + 2 : why;
        (void)iso_fault_set_code(fault, ISO_FAULT_MODULE_UNFIT, -EBADMSG,
                                 "the module %s cannot be loaded: %s", path, why);
    }
    return handle;
}

static int check_table(const struct iso_module *table, const char *path, const char *name,
                       size_t size_bytes, struct iso_fault *fault)
{
    if (!table) {
        return iso_fault_set_code(fault, ISO_FAULT_MODULE_UNFIT, -EBADMSG,
                                  "%s is not a module of Isotherm", path);
    }
    if (table->abi != ISO_MODULE_ABI) {
        return iso_fault_set_code(fault, ISO_FAULT_MODULE_UNFIT, -EBADMSG,
                                  "the module %s has interface %u, not %d", path,
                                  (unsigned)table->abi, ISO_MODULE_ABI);
    }
    if (strcmp(table->name, name) != 0) {
        return iso_fault_set_code(fault, ISO_FAULT_MODULE_UNFIT, -EBADMSG,
                                  "the module %s is '%s', not '%s'", path, table->name, name);
    }
    if (strcmp(table->version, ISOTHERM_VERSION) != 0) {
        return iso_fault_set_code(fault, ISO_FAULT_MODULE_UNFIT, -EBADMSG,
                                  "the module %s has version %s; this program has %s", path,
                                  table->version, ISOTHERM_VERSION);
    }
    return table->size_bytes == size_bytes
               ? 0
               : iso_fault_set_code(fault, ISO_FAULT_MODULE_UNFIT, -EBADMSG,
                                    "the module %s has a table of %u bytes, not %zu", path,
                                    (unsigned)table->size_bytes, size_bytes);
}

int iso_module_read(const char *path, const char *name, size_t size_bytes,
                    const struct iso_module **out, struct iso_fault *fault)
{
    int error = check_file(path, name, fault);
    if (error) {
        return error;
    }
    void *handle = open_file(path, fault);
    if (!handle) {
        return -EBADMSG;
    }
    const struct iso_module *table = dlsym(handle, "iso_module");
    error = check_table(table, path, name, size_bytes, fault);
    if (!error) {
        *out = table;
    }
    return error;
}

/* ---- loading once in a process ---- */

static int try(struct iso_module_slot *slot)
{
    char path[PATH_MAX];
    const int error = iso_module_path(slot->name, path, &slot->fault);
    return error ? error
                 : iso_module_read(path, slot->name, slot->size_bytes, &slot->table, &slot->fault);
}

int iso_module_load(struct iso_module_slot *slot, struct iso_fault *fault)
{
    (void)pthread_mutex_lock(&lock);
    if (!slot->tried) {
        slot->error = try(slot);
        slot->tried = true;
    }
    const int error = slot->error;
    (void)pthread_mutex_unlock(&lock);
    return error ? iso_fault_set_code(fault, slot->fault.code, error, "%s", slot->fault.text) : 0;
}
