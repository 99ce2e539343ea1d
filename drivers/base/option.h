/* Options of back ends. A back end publishes a table of its options (struct iso_option_spec, ended
 * by an entry without a name); the configuration, the help and the manual are made from the tables
 * or checked against them. The options that are set are a list of keys and values (struct
 * iso_option). An empty value means the same as an option that is not given: the standard value of
 * the table is used. */
#ifndef ISO_DRIVERS_BASE_OPTION_H
#define ISO_DRIVERS_BASE_OPTION_H

#include <stdbool.h>
#include <stddef.h>

#include "core/base/fault.h"

/* One option that is set. */
struct iso_option {
    const char *key, *value;
};

enum iso_option_kind {
    ISO_OPTION_TEXT = 0,
    ISO_OPTION_PATH, /* a file that is read while the sensor or the door works; isothermd permits
                        itself to read the directory of the file */
    ISO_OPTION_LINE, /* a line to the door's hardware; `isotherm status` lists those that are set */
    ISO_OPTION_NUMBER, /* a decimal number, min to max */
    ISO_OPTION_COUNT,  /* a whole number, min to max */
    ISO_OPTION_CHOICE, /* one of the words of `choices` */
    ISO_OPTION_SWITCH, /* no or yes */
};

/* One option that a back end has. All texts outlive the table. */
struct iso_option_spec {
    const char *name; /* small letters, digits, '_'; NULL ends the table */
    enum iso_option_kind kind;
    double min, max;      /* of NUMBER and COUNT */
    const char *choices;  /* of CHOICE: "word|word" */
    const char *standard; /* the value that holds if the option is not given; "": none */
    const char *help;     /* one line, without a full stop */
    bool required;        /* must be given, and has no standard value */
    bool tools_only;      /* for programs that open the back end themselves, such as `isotherm-sim
                             record`; a configuration file must not have it */

    /* OPTIONAL. Checks what kind and range cannot express about a value that is not empty: returns
     * 0, or -EINVAL with a fault such as "'foo' is not a line". Opens no file and uses no
     * device. */
    int (*check)(const char *value, struct iso_fault *fault);
};

/* The options of a table and the values that are set. */
struct iso_option_set {
    const struct iso_option_spec *specs; /* NULL: there are none */
    const struct iso_option *options;    /* [n_options] */
    size_t n_options;
};

/* The option of a name, or NULL. `specs` may be NULL. */
const struct iso_option_spec *iso_option_find_spec(const struct iso_option_spec *specs,
                                                   const char *name);

/* Finds a word in a list of words that '|' separates. Returns its index, which begins with 0, or -1
 * if the list does not have the word. */
int iso_option_find_choice(const char *choices, const char *word);

/* Writes the values that are allowed: "no|yes", "a number, 0 to 1", or "" for texts of any form. */
void iso_option_describe(const struct iso_option_spec *spec, char *text, size_t size);

/* Whether an option may have a value: 0, or -EINVAL with a fault that names the option and what was
 * expected, such as "bad value 'soon' for 'fps' (a number, 1 to 1000)". An empty value is fine. */
int iso_option_check_value(const struct iso_option_spec *spec, const char *value,
                           struct iso_fault *fault) __attribute__((warn_unused_result));

/* Refuses options that are not in the table, repeated ones, bad values and missing required
 * options: 0, or -EINVAL with a fault that begins with `owner` (such as "sensor replay") and names
 * the option. */
int iso_options_check(const char *owner, const struct iso_option_set *set, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The value of the first option of a list that has this key, or NULL. */
const char *iso_options_find(const struct iso_option *options, size_t n_options, const char *key);

/* Whether an option is set to a value that is not empty. */
bool iso_option_is_given(const struct iso_option_set *set, const char *name);

/* The value of an option of the table, after iso_options_check has accepted the set: the given
 * value, or else the standard value. The text belongs to the set. A number is 0 if there is neither
 * value. A choice is the index of the word in `choices`, from 0 on, or -1 if there is neither
 * value. */
const char *iso_option_text(const struct iso_option_set *set, const char *name);
bool iso_option_switch(const struct iso_option_set *set, const char *name);
double iso_option_number(const struct iso_option_set *set, const char *name);
int iso_option_choice(const struct iso_option_set *set, const char *name);

#endif
