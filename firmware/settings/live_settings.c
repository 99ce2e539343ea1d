#include "firmware/settings/live_settings.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

void iso_live_settings_init(struct iso_live_settings *settings, struct iso_config *config,
                            const char *path, const struct iso_key_ring *ring)
{
    *settings = (struct iso_live_settings){
        .config = config, .configured = *config, .path = path, .ring = ring};
}

/* ---- at the start ---- */

static void report(iso_live_settings_warn warn, void *context,
                   const struct iso_stored_setting *item, const struct iso_fault *why)
{
    char text[320];
    (void)snprintf(text, sizeof text,
                   "the stored setting [%s] %s = %s is not used, the configuration file's value "
                   "holds: %.160s",
                   item->section, item->key, item->value, why->text);
    warn(context, text);
}

/* Applies the items that fit to the configuration now; the others stay in `left`. Returns how many
 * were applied. An item may fit only after a later one was applied, so the caller repeats this
 * until nothing more can be applied. */
static size_t apply_some(struct iso_config *config, const struct iso_settings_file *file,
                         bool left[ISO_LIVE_KEYS_MAX])
{
    size_t n = 0;
    for (size_t i = 0; i < file->n; i++) {
        const struct iso_stored_setting *item = &file->items[i];
        const struct iso_config_key *key = iso_live_key_find(item->section, item->key);
        if (left[i] && key && iso_live_key_set(config, key, item->value, NULL) == 0) {
            left[i] = false;
            n++;
        }
    }
    return n;
}

/* Reports the items that are left, and takes them out of the file. */
static void drop_left(const struct iso_live_settings *settings, struct iso_settings_file *file,
                      const bool left[ISO_LIVE_KEYS_MAX], iso_live_settings_warn warn,
                      void *context)
{
    size_t n = 0;
    for (size_t i = 0; i < file->n; i++) {
        const struct iso_stored_setting *item = &file->items[i];
        const struct iso_config_key *key = NULL;
        struct iso_fault why = {.text = ""};
        if (!left[i]) {
            file->items[n++] = *item;
        } else if (iso_live_key_need(item->section, item->key, &key, &why) ||
                   iso_live_key_set(settings->config, key, item->value, &why)) {
            report(warn, context, item, &why);
        }
    }
    file->n = n;
}

int iso_live_settings_load(struct iso_live_settings *settings, iso_live_settings_warn warn,
                           void *context, struct iso_fault *fault)
{
    struct iso_settings_file file = {.number = 0};
    bool left[ISO_LIVE_KEYS_MAX];
    const int error = *settings->path
                          ? iso_settings_file_read(settings->path, settings->ring, &file, fault)
                          : -ENOENT;
    if (error) {
        return error == -ENOENT ? 0 : error;
    }
    *settings->config = settings->configured;
    memset(left, 1, sizeof left);
    while (apply_some(settings->config, &file, left) > 0) {
    }
    drop_left(settings, &file, left, warn, context);
    settings->file = file;
    return 0;
}

/* ---- a change ---- */

int iso_live_settings_check(const struct iso_live_settings *settings, const char *section,
                            const char *name, const char *value, struct iso_live_change *out,
                            struct iso_fault *fault)
{
    struct iso_live_change change = {.config = *settings->config, .reset = !value};
    char configured[ISO_LIVE_VALUE_SIZE];
    int error = iso_live_key_need(section, name, &change.key, fault);
    if (error) {
        return error;
    }
    iso_live_key_print(&change.config, change.key, change.before);
    iso_live_key_print(&settings->configured, change.key, configured);
    error = iso_live_key_set(&change.config, change.key, value ? value : configured, fault);
    if (error) {
        return error;
    }
    iso_live_key_print(&change.config, change.key, change.after);
    *out = change;
    return 0;
}

/* Takes the key out of the file, and adds it with its new value unless it is reset. */
static void change_file(struct iso_settings_file *file, const struct iso_live_change *change)
{
    size_t n = 0;
    for (size_t i = 0; i < file->n; i++) {
        if (strcmp(file->items[i].section, change->key->section) != 0 ||
            strcmp(file->items[i].key, change->key->name) != 0) {
            file->items[n++] = file->items[i];
        }
    }
    file->n = n;
    if (!change->reset) {
        struct iso_stored_setting *item = &file->items[file->n++];
        (void)snprintf(item->section, sizeof item->section, "%s", change->key->section);
        (void)snprintf(item->key, sizeof item->key, "%s", change->key->name);
        (void)snprintf(item->value, sizeof item->value, "%s", change->after);
    }
}

int iso_live_settings_make(struct iso_live_settings *settings, const struct iso_live_change *change,
                           struct iso_fault *fault)
{
    struct iso_settings_file file = settings->file;
    change_file(&file, change);
    const int error = *settings->path
                          ? iso_settings_file_write(settings->path, settings->ring, &file, fault)
                          : 0;
    if (error) {
        return error;
    }
    settings->file = file;
    *settings->config = change->config;
    return 0;
}

int iso_live_settings_renew(struct iso_live_settings *settings, struct iso_fault *fault)
{
    if (!*settings->path || settings->file.number == 0) {
        return 0;
    }
    return iso_settings_file_write(settings->path, settings->ring, &settings->file, fault);
}
