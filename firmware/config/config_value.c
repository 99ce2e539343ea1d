#include "firmware/config/config_value.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "drivers/file/text.h"

_Static_assert(sizeof(enum iso_door_fail) == sizeof(int), "choices are stored as int");
_Static_assert(sizeof(enum iso_counter_kind) == sizeof(int), "choices are stored as int");
_Static_assert(sizeof(enum iso_image_check) == sizeof(int), "choices are stored as int");
_Static_assert(sizeof(enum iso_icp_transform) == sizeof(int), "choices are stored as int");

static int store_text(const char *value, void *field)
{
    if (strlen(value) >= ISO_CONFIG_TEXT_SIZE) {
        return -EINVAL;
    }
    memset(field, 0, ISO_CONFIG_TEXT_SIZE);
    memcpy(field, value, strlen(value));
    return 0;
}

static int store_count(const struct iso_config_key *key, const char *value, void *field)
{
    size_t count;
    if (iso_text_count(value, &count) || (double)count < key->min || (double)count > key->max) {
        return -EINVAL;
    }
    memcpy(field, &(int){(int)count}, sizeof(int));
    return 0;
}

static int store_number(const struct iso_config_key *key, const char *value, void *field)
{
    double number;
    if (iso_text_number(value, &number) || number < key->min || number > key->max) {
        return -EINVAL;
    }
    memcpy(field, &number, sizeof number);
    return 0;
}

static int store_choice(const char *choices, const char *value, void *field, size_t size)
{
    const int choice = iso_option_find_choice(choices, value);
    if (choice < 0) {
        return -EINVAL;
    }
    if (size == sizeof(bool)) {
        memcpy(field, &(bool){choice != 0}, sizeof(bool));
    } else {
        memcpy(field, &choice, sizeof choice);
    }
    return 0;
}

int iso__config_store(const struct iso_config_key *key, const char *value,
                      struct iso_config *config)
{
    void *field = (char *)config + key->offset;
    switch (key->type) {
    case ISO_CONFIG_TEXT:
        return store_text(value, field);
    case ISO_CONFIG_NUMBER:
        return store_number(key, value, field);
    case ISO_CONFIG_COUNT:
        return store_count(key, value, field);
    case ISO_CONFIG_CHOICE:
        return store_choice(key->choices, value, field, sizeof(int));
    case ISO_CONFIG_SWITCH:
        return store_choice("no|yes", value, field, sizeof(bool));
    }
    return -EINVAL;
}

/* ---- as text ---- */

/* Writes the shortest decimal number that reads back as the same. */
static void print_number(double number, char *text, size_t size)
{
    double read = 0;
    for (int digits = 9; digits <= 17; digits++) {
        (void)snprintf(text, size, "%.*g", digits, number);
        if (iso_text_number(text, &read) == 0 && read == number) {
            return;
        }
    }
}

static void print_choice(const char *choices, int choice, char *text, size_t size)
{
    for (; choice > 0 && *choices; choice--) {
        choices = strchrnul(choices, '|');
        choices += *choices ? 1 : 0;
    }
    (void)snprintf(text, size, "%.*s", (int)strcspn(choices, "|"), choices);
}

void iso__config_print(const struct iso_config_key *key, const struct iso_config *config,
                       char *text, size_t size)
{
    const void *field = (const char *)config + key->offset;
    double number;
    int count;
    bool on;
    switch (key->type) {
    case ISO_CONFIG_TEXT:
        (void)snprintf(text, size, "%s", (const char *)field);
        break;
    case ISO_CONFIG_NUMBER:
        memcpy(&number, field, sizeof number);
        print_number(number, text, size);
        break;
    case ISO_CONFIG_COUNT:
        memcpy(&count, field, sizeof count);
        (void)snprintf(text, size, "%d", count);
        break;
    case ISO_CONFIG_CHOICE:
        memcpy(&count, field, sizeof count);
        print_choice(key->choices, count, text, size);
        break;
    case ISO_CONFIG_SWITCH:
        memcpy(&on, field, sizeof on);
        (void)snprintf(text, size, "%s", on ? "yes" : "no");
        break;
    }
}

void iso__config_describe(const struct iso_config_key *key, char *text, size_t size)
{
    switch (key->type) {
    case ISO_CONFIG_TEXT:
        (void)snprintf(text, size, "text of less than %d bytes", ISO_CONFIG_TEXT_SIZE);
        break;
    case ISO_CONFIG_NUMBER:
        (void)snprintf(text, size, "a number, %g to %g", key->min, key->max);
        break;
    case ISO_CONFIG_COUNT:
        (void)snprintf(text, size, "a whole number, %.0f to %.0f", key->min, key->max);
        break;
    case ISO_CONFIG_CHOICE:
        (void)snprintf(text, size, "%s", key->choices);
        break;
    case ISO_CONFIG_SWITCH:
        (void)snprintf(text, size, "no|yes");
        break;
    }
}
