/* The settings in force: those of the configuration file, and over them those that were changed
 * while the daemon ran. The changes are kept in a file (settings_file.h).
 *
 * One thread. */
#ifndef ISO_FIRMWARE_SETTINGS_LIVE_SETTINGS_H
#define ISO_FIRMWARE_SETTINGS_LIVE_SETTINGS_H

#include "firmware/settings/settings_file.h"

struct iso_live_settings {
    struct iso_config *config;       /* in force; borrowed */
    struct iso_config configured;    /* as the configuration file has it */
    const char *path;                /* borrowed; "": changes are lost at the end */
    const struct iso_key_ring *ring; /* borrowed; may be NULL with an empty path */
    struct iso_settings_file file;   /* the changes */
};

/* Begins with the configuration as the file has it. What the pointers point to must outlive it. */
void iso_live_settings_init(struct iso_live_settings *settings, struct iso_config *config,
                            const char *path, const struct iso_key_ring *ring);

/* Reports a stored setting that cannot be used; the configuration file's value holds instead. */
typedef void (*iso_live_settings_warn)(void *context, const char *text);

/* Reads the file and applies the changes to *config. A setting that this version does not know, or
 * that does not fit to the others any more, is reported and left out. Returns 0 also if there is no
 * file. After an error nothing is changed: the errors of iso_settings_file_read except -ENOENT. */
int iso_live_settings_load(struct iso_live_settings *settings, iso_live_settings_warn warn,
                           void *context, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* A change that was checked and is not made yet. */
struct iso_live_change {
    const struct iso_config_key *key;
    char before[ISO_LIVE_VALUE_SIZE], after[ISO_LIVE_VALUE_SIZE]; /* the values in force */
    bool reset;               /* back to the value of the configuration file */
    struct iso_config config; /* after the change */
};

/* Checks a change. value: in the form of the file; NULL: back to the value of the configuration
 * file. -EINVAL: the errors of iso_live_key_need and iso_live_key_set. */
int iso_live_settings_check(const struct iso_live_settings *settings, const char *section,
                            const char *name, const char *value, struct iso_live_change *out,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes the file with the change, and then makes the change in *config. After an error, one of
 * iso_settings_file_write, neither has happened, except that the file may have it unsynchronised.
 */
int iso_live_settings_make(struct iso_live_settings *settings, const struct iso_live_change *change,
                           struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes the file again, with the newest key. The errors of iso_settings_file_write. */
int iso_live_settings_renew(struct iso_live_settings *settings, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
