/* Modules: shared objects with the back ends that pull in other libraries (OpenCV, libcamera, the
 * TPM software stack). A program loads a module when its configuration asks for it; otherwise it
 * runs without these libraries.
 *
 * A module is next to the libisotherm-core.so that the process already uses, and is called
 * isotherm-NAME.so: /usr/lib/x86_64-linux-gnu/isotherm/isotherm-stereo.so. There is
 * no search path, and no variable of the environment or key of the configuration names another
 * place: whoever can put a file there could as well replace the library itself.
 *
 * A module exports one symbol, `iso_module`: a struct that begins with a struct iso_module and goes
 * on with pointers to its functions. It must be of the very version of the program. A module stays
 * loaded until the process ends. */
#ifndef ISO_DRIVERS_BASE_MODULE_H
#define ISO_DRIVERS_BASE_MODULE_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Rises when this struct or the table of a module changes its meaning. */
enum { ISO_MODULE_ABI = 1 };

/* The begin of every module's table. The first two members never change. */
struct iso_module {
    uint32_t abi;        /* ISO_MODULE_ABI */
    uint32_t size_bytes; /* of the whole table */
    const char *name;    /* "stereo" */
    const char *version; /* of the project */
};

/* Initialises the begin of a table. */
#define ISO_MODULE(NAME, TABLE)                                             \
    {                                                                       \
        .abi = ISO_MODULE_ABI, .size_bytes = sizeof(TABLE), .name = (NAME), \
        .version = ISOTHERM_VERSION                                         \
    }

#define ISO_MODULE_EXPORT __attribute__((visibility("default")))

/* A module that a program needs, and the result of loading it. The program sets the first two
 * members; all others are zero at the beginning. */
struct iso_module_slot {
    const char *name;  /* the package that has it is called isotherm-NAME */
    size_t size_bytes; /* of the table */

    /* Of the loader. */
    bool tried;
    int error;
    struct iso_fault fault;
    const struct iso_module *table;
};

/* Loads a module, or returns the result of the first attempt: a process reads the disk once. Any
 * thread may call it. After 0 slot->table is set. One line in *fault for every error: -ENOENT there
 * is no such file (the line names the package to install), -EBADMSG it is not a regular file,
 * anybody may write to it, it cannot be loaded, or it is not this module in this version. */
int iso_module_load(struct iso_module_slot *slot, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The same from a named file, asking the disk every time: for iso_module_load and for tests. */
int iso_module_read(const char *path, const char *name, size_t size_bytes,
                    const struct iso_module **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Where the module of a name has to lie. -ENOENT with a fault if the library's own place is not
 * known, -ENAMETOOLONG. */
int iso_module_path(const char *name, char path[PATH_MAX], struct iso_fault *fault)
    __attribute__((warn_unused_result));

#ifdef __cplusplus
}
#endif
#endif
