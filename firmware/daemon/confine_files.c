/* Landlock (linux/landlock.h), by its system calls, because the C library has no functions for
 * them. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <link.h>
#include <linux/landlock.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "drivers/base/shipped.h"
#include "firmware/daemon/confine.h"

/* Rights of later versions of the interface, which the installed header may lack. */
#ifndef LANDLOCK_ACCESS_FS_REFER
#define LANDLOCK_ACCESS_FS_REFER (1ULL << 13)
#endif
#ifndef LANDLOCK_ACCESS_FS_TRUNCATE
#define LANDLOCK_ACCESS_FS_TRUNCATE (1ULL << 14)
#endif

static const uint64_t reading = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
static const uint64_t writing = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_FILE |
                                LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_TRUNCATE;
static const uint64_t of_files = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE |
                                 LANDLOCK_ACCESS_FS_TRUNCATE;

struct ruleset {
    int fd;
    uint64_t handled; /* the rights that are restricted */
};

/* All rights of version 1 are handled. Version 2 added REFER and version 3 TRUNCATE. The rights of
 * later versions are not restricted. */
static uint64_t rights_of(long version)
{
    uint64_t rights = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1;
    rights |= version >= 2 ? LANDLOCK_ACCESS_FS_REFER : 0;
    return rights | (version >= 3 ? LANDLOCK_ACCESS_FS_TRUNCATE : 0);
}

/* Allows access beneath a path. A path that does not exist, or that this process cannot reach,
 * needs no rule. */
static int allow_path(const struct ruleset *ruleset, const char *path, uint64_t rights)
{
    struct landlock_path_beneath_attr beneath = {0};
    const int fd = open(path, O_PATH | O_CLOEXEC);
    if (fd < 0) {
        return errno == ENOENT || errno == ENOTDIR || errno == EACCES ? 0 : -errno;
    }
    const int directory = open(path, O_PATH | O_DIRECTORY | O_CLOEXEC);
    beneath.parent_fd = fd;
    beneath.allowed_access = rights & ruleset->handled & (directory < 0 ? of_files : UINT64_MAX);
    const long r = syscall(SYS_landlock_add_rule, ruleset->fd, LANDLOCK_RULE_PATH_BENEATH, &beneath,
                           0);
    const int error = r ? -errno : 0;
    if (directory >= 0) {
        (void)close(directory);
    }
    (void)close(fd);
    return error;
}

/* Allows access to the directory that contains a file. */
static int allow_beside(const struct ruleset *ruleset, const char *path, uint64_t rights)
{
    char directory[PATH_MAX];
    const char *slash = strrchr(path, '/');
    const size_t length = slash ? (size_t)(slash - path) : 0;
    if (length >= sizeof directory) {
        return -ENAMETOOLONG;
    }
    if (!slash) {
        return allow_path(ruleset, ".", rights);
    }
    (void)snprintf(directory, sizeof directory, "%.*s", (int)length, path);
    return allow_path(ruleset, length == 0 ? "/" : directory, rights);
}

static int allow_system(const struct ruleset *ruleset)
{
    static const char *const read[] = {"/usr", "/lib", "/lib64", "/etc", "/sys", "/proc", "/run"};
    static const char *const write[] = {"/dev", "/tmp", "/var/tmp", "/dev/shm"};
    int error = 0;
    for (size_t i = 0; !error && i < sizeof read / sizeof *read; i++) {
        error = allow_path(ruleset, read[i], reading);
    }
    for (size_t i = 0; !error && i < sizeof write / sizeof *write; i++) {
        error = allow_path(ruleset, write[i], reading | (i == 0 ? of_files : writing));
    }
    return error;
}

struct loaded {
    const struct ruleset *ruleset;
    int error;
};

static int allow_beside_library(struct dl_phdr_info *library, size_t size, void *context)
{
    (void)size;
    struct loaded *loaded = context;
    if (strchr(library->dlpi_name, '/')) {
        loaded->error = allow_beside(loaded->ruleset, library->dlpi_name, reading);
    }
    return loaded->error;
}

/* A library may later load more files from its own directory; OpenNI2 loads its drivers from
 * there. */
static int allow_libraries(const struct ruleset *ruleset)
{
    struct loaded loaded = {.ruleset = ruleset};
    (void)dl_iterate_phdr(allow_beside_library, &loaded);
    return loaded.error;
}

/* Allows reading the files that options of a back end name. */
static int allow_options(const struct ruleset *ruleset, const struct iso_config_options *options)
{
    int error = 0;
    for (size_t i = 0; !error && i < options->n; i++) {
        const struct iso_config_option *option = &options->list[i];
        if (option->spec->kind == ISO_OPTION_PATH) {
            error = allow_beside(ruleset, option->value, reading);
        }
    }
    return error;
}

static int allow_configured(const struct ruleset *ruleset, const struct iso_config *config)
{
    const char *const stores[] = {config->gallery.path, config->log.path, config->lockout.path,
                                  config->seal.key};
    const char *const named[] = {
        config->model.head,          config->model.metric, config->model.cohort,
        config->recognition.cascade, config->door.cards,   config->reader.osdp_key,
        config->login.users,         ISOTHERM_DATA_DIR,    iso_shipped_model()};
    int error = strcmp(config->sensor.backend, "replay") == 0 ? allow_path(ruleset, "/", reading)
                                                              : 0;
    for (size_t i = 0; !error && i < sizeof stores / sizeof *stores; i++) {
        error = *stores[i] ? allow_beside(ruleset, stores[i], reading | writing) : 0;
    }
    if (!error && *config->seal.credentials) {
        error = allow_path(ruleset, config->seal.credentials, reading);
    }
    for (size_t i = 0; !error && i < sizeof named / sizeof *named; i++) {
        error = *named[i] ? allow_beside(ruleset, named[i], reading) : 0;
    }
    if (!error) {
        error = allow_options(ruleset, &config->sensor.options);
    }
    return error ? error : allow_options(ruleset, &config->door.options);
}

static int restrict_files(const struct iso_config *config, struct iso_fault *fault)
{
    const long version = syscall(SYS_landlock_create_ruleset, NULL, 0,
                                 LANDLOCK_CREATE_RULESET_VERSION);
    if (version < 1) {
        return iso_fault_set_code(fault, ISO_FAULT_NOT_CONFINED, -ENOSYS,
                                  "files are not confined: the kernel has no Landlock");
    }
    struct landlock_ruleset_attr attributes = {.handled_access_fs = rights_of(version)};
    const struct ruleset ruleset = {
        .fd = (int)syscall(SYS_landlock_create_ruleset, &attributes,
                           sizeof attributes.handled_access_fs, 0),
        .handled = attributes.handled_access_fs,
    };
    if (ruleset.fd < 0) {
        return iso_fault_set_code(fault, ISO_FAULT_NOT_CONFINED, -errno,
                                  "files are not confined: %m");
    }
    int error = allow_system(&ruleset);
    if (!error) {
        error = allow_libraries(&ruleset);
    }
    if (!error) {
        error = allow_configured(&ruleset, config);
    }
    if (!error && syscall(SYS_landlock_restrict_self, ruleset.fd, 0)) {
        error = -errno;
    }
    (void)close(ruleset.fd);
    return error ? iso_fault_set_code(fault, ISO_FAULT_NOT_CONFINED, error,
                                      "files are not confined: %s", strerror(-error))
                 : 0;
}

int iso_confine_files(const struct iso_config *config, struct iso_fault *fault)
{
#ifdef ISOTHERM_INSTRUMENTED
    (void)config;
    return iso_fault_set_code(fault, ISO_FAULT_NOT_CONFINED, -ENOTSUP,
                              "this build is instrumented and confines nothing");
#endif
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)) {
        return iso_fault_set_code(fault, ISO_FAULT_NOT_CONFINED, -errno, "new privileges: %m");
    }
    return restrict_files(config, fault);
}
