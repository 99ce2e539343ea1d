/* The configuration of the appliance: an INI file, read strictly.
 *
 * One table (iso_config_keys) describes every key of the appliance. It controls parsing, the help
 * and the sample file, so that they cannot disagree. [sensor] and [door] also have the options of
 * the back end that their key `backend` names, wherever in the section that key is; the back end's
 * table (drivers/base/option.h) controls the same things. These are refused with "FILE:LINE: what
 * is wrong": an unknown section or key, an option that only other back ends have (the fault names
 * them; an option without a value is accepted), a bad value, a repeated key, and a line that is not
 * `key = value`. Keys that contradict each other are refused with "FILE: what is wrong". ';' or '#'
 * begins a line of comment; " ;" begins a comment after a value. A line has at most 190 bytes. */
#ifndef ISO_FIRMWARE_CONFIG_CONFIG_H
#define ISO_FIRMWARE_CONFIG_CONFIG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "core/base/fault.h"
#include "core/registration/icp.h"
#include "drivers/base/option.h"
#include "firmware/door/door.h"
#include "firmware/recognise/pipeline.h"

enum { ISO_CONFIG_TEXT_SIZE = 192, ISO_CONFIG_OPTIONS_MAX = 16, ISO_CONFIG_KEYS_MAX = 128 };

/* The options of a back end that the file sets, in the order of their lines. */
struct iso_config_options {
    size_t n;
    struct iso_config_option {
        const struct iso_option_spec *spec; /* points into the back end's table */
        char value[ISO_CONFIG_TEXT_SIZE];   /* not empty */
        int line;                           /* line of the file; 0: not from a file */
    } list[ISO_CONFIG_OPTIONS_MAX];
};

struct iso_config_sensor {
    char backend[ISO_CONFIG_TEXT_SIZE];
    struct iso_config_options options;
    double distance_min_mm, distance_max_mm;
    int pause_ms, silence_ms, stale_ms, retry_ms, retry_max_ms;
    int rest_s; /* 0: never */
};

struct iso_config_door {
    char backend[ISO_CONFIG_TEXT_SIZE];
    struct iso_config_options options;
    char cards[ISO_CONFIG_TEXT_SIZE];
    enum iso_door_fail fail;
    int unlock_ms, relay_pulse_ms, held_ms, refused_ms, poll_ms, retry_ms, retry_max_ms;
};

/* A card reader or keypad, on Wiegand lines (drivers/reader/wiegand_in.h) or over OSDP
 * (drivers/reader/osdp_reader_port.h), not both. */
struct iso_config_reader {
    char d0[ISO_CONFIG_TEXT_SIZE], d1[ISO_CONFIG_TEXT_SIZE]; /* both "": no Wiegand lines */
    char osdp_port[ISO_CONFIG_TEXT_SIZE];                    /* "": no OSDP */
    int osdp_address, osdp_baud;                             /* osdp_baud: iso_config_reader_baud */
    char osdp_key[ISO_CONFIG_TEXT_SIZE]; /* file of the key (daemon/reader_key.h); "": plain */
};

/* The bus of an access panel (firmware/panel/panel.h). */
struct iso_config_panel {
    char port[ISO_CONFIG_TEXT_SIZE]; /* "": there is no panel */
    int address, baud;               /* baud: iso_config_panel_baud */
    bool plain;
    int card_bits; /* iso_config_panel_card_bits */
};

struct iso_config_gallery {
    char path[ISO_CONFIG_TEXT_SIZE];
    int capacity; /* people */
};

struct iso_config_recognition {
    enum iso_image_check intensity;
    char cascade[ISO_CONFIG_TEXT_SIZE];
};

/* How two faces are compared. */
struct iso_config_match {
    enum iso_method method;
    bool adapt; /* the metric adapts to the enrolled people (firmware/site/site_index.h) */
    double trim;
    int icp_iterations;
    enum iso_icp_transform transform;
};

/* The security level: the share of the visits of strangers that may be let in, which is 1e-2, 1e-3
 * or 1e-4 (iso_config_threshold_among). */
enum iso_level { ISO_LEVEL_CONVENIENT = 0, ISO_LEVEL_BALANCED, ISO_LEVEL_STRICT };

struct iso_config_decision {
    enum iso_level level;
    double threshold; /* 0: the threshold of the level */
    double margin;
    int agree, max_frames, attack_frames, gap_ms, refractory_ms;
};

/* What the appliance learns about people from confident matches (learning.h). */
struct iso_config_update {
    int templates; /* of one person, at most; 0: none, and learned templates are deleted */
    double score;
};

struct iso_config_lockout {
    int failures, attacks; /* 0: they never lock the door */
    int first_ms, longest_ms, forget_ms;
    char path[ISO_CONFIG_TEXT_SIZE];
};

/* Who may enter where and when (firmware/access/site_access.h). */
struct iso_config_policy {
    char access_point[ISO_CONFIG_TEXT_SIZE]; /* of this door in the policy; "": the only one */
    int factor_ms;   /* how long a card, a PIN or a second person is waited for */
    bool card_alone; /* a card is enough while the sensor does not work */
};

struct iso_config_motion {
    double still_mm_s, still_deg_s, jump_mm_s, jump_deg_s;
    int lifeless_ms, frozen_frames; /* 0: not checked */
};

struct iso_config_hint {
    int hold_frames, interval_ms;
};

struct iso_config_enroll {
    int stages, timeout_ms;
    int pose_stages, pose_timeout_ms; /* of each pose but the frontal one */
    double pose_yaw_deg, pose_pitch_deg, pose_within_deg, pose_coverage_min;
    double agree_score, duplicate_score;
    double yaw_max_deg, pitch_max_deg, coverage_min, landmark_coverage_min, expression_max;
    double mouth_max_mm;
};

/* How the daemon notices that the whole state directory is of an earlier time. */
enum iso_counter_kind { ISO_COUNTER_NONE = 0, ISO_COUNTER_TPM2 };

struct iso_config_seal {
    char key[ISO_CONFIG_TEXT_SIZE]; /* "": next to the gallery */
    enum iso_counter_kind counter;
    char counter_tcti[ISO_CONFIG_TEXT_SIZE], counter_index[ISO_CONFIG_TEXT_SIZE];
    /* The directory in which the service manager puts the keys. It is not a key of the file. */
    char credentials[ISO_CONFIG_TEXT_SIZE];
    bool migrate;
};

struct iso_config_log {
    char path[ISO_CONFIG_TEXT_SIZE];
    bool sync, journal;
    int max_mib;
};

struct iso_config_bus {
    char address[ISO_CONFIG_TEXT_SIZE]; /* "system", "session" or a D-Bus address */
    int action_ms, claim_ms;
};

/* Logins of the machine that the daemon runs on (pam_isotherm). */
struct iso_config_login {
    bool desk;                        /* the machine guards no door, so logins may use the camera */
    char users[ISO_CONFIG_TEXT_SIZE]; /* which person a Unix user is (contract/login_users.h) */
    int longest_ms;
};

/* The factory reset (firmware/reset). */
struct iso_config_reset {
    char button[ISO_CONFIG_TEXT_SIZE];     /* a GPIO line; "": there is none */
    char credential[ISO_CONFIG_TEXT_SIZE]; /* the file of the encrypted key of the appliance */
    char web[ISO_CONFIG_TEXT_SIZE];        /* the folder of the web server's state */
    char link[ISO_CONFIG_TEXT_SIZE];       /* the folder of the link's state */
};

/* The fleet to which the door belongs. */
struct iso_config_fleet {
    char restart_hours[ISO_CONFIG_TEXT_SIZE]; /* drivers/base/restart_hours.h; "": the whole day */
};

struct iso_config_process {
    bool confine;
};

struct iso_config_model {
    char head[ISO_CONFIG_TEXT_SIZE], metric[ISO_CONFIG_TEXT_SIZE], cohort[ISO_CONFIG_TEXT_SIZE];
};

struct iso_config {
    struct iso_config_sensor sensor;
    struct iso_config_door door;
    struct iso_config_panel panel;
    struct iso_config_reader reader;
    struct iso_config_gallery gallery;
    struct iso_config_seal seal;
    struct iso_config_recognition recognition;
    struct iso_config_match match;
    struct iso_config_decision decision;
    struct iso_config_update update;
    struct iso_config_lockout lockout;
    struct iso_config_policy policy;
    struct iso_config_motion motion;
    struct iso_config_hint hint;
    struct iso_config_enroll enroll;
    struct iso_config_log log;
    struct iso_config_bus bus;
    struct iso_config_login login;
    struct iso_config_reset reset;
    struct iso_config_fleet fleet;
    struct iso_config_process process;
    struct iso_config_model model;
    const char *obsolete; /* the last obsolete key in the file, "[section] name"; NULL: none */
};

enum iso_config_type {
    ISO_CONFIG_TEXT,   /* char[ISO_CONFIG_TEXT_SIZE] */
    ISO_CONFIG_NUMBER, /* double, min..max */
    ISO_CONFIG_COUNT,  /* int, min..max */
    ISO_CONFIG_CHOICE, /* enumeration: the number of the word among `choices` */
    ISO_CONFIG_SWITCH, /* bool: no or yes */
};

struct iso_config_key {
    const char *section, *name;
    enum iso_config_type type;
    size_t offset;        /* offset in struct iso_config */
    double min, max;      /* for numbers and counts */
    const char *choices;  /* "word|word" */
    const char *standard; /* value without configuration, as text of the file */
    const char *help;     /* one line */
};

extern const struct iso_config_key iso_config_keys[];
extern const size_t iso_config_n_keys;

/* A key of an earlier version: "[section] name"; NULL for every other key. A file that still has
 * such a key, with any value, is accepted, so that the daemon starts after an upgrade. */
const char *iso_config_find_obsolete(const char *section, const char *name);

/* Whether the door has a lock of its own. False: the appliance only sends card numbers to an access
 * controller, which has the lock. */
bool iso_config_has_relay(const struct iso_config *config);

/* The speed of the panel's bus and the number of bits of a card, of which the configuration has the
 * numbers of words. */
unsigned iso_config_panel_baud(const struct iso_config *config);
unsigned iso_config_reader_baud(const struct iso_config *config);
int iso_config_panel_card_bits(const struct iso_config *config);

/* The lowest score at which a face counts as a person's: the threshold if one is set, else that of
 * the level. With the metric, one of 10^s similar strangers reaches a score of s (metric.h). */
double iso_config_threshold(const struct iso_config *config);

/* The same for a face that is compared with so many people. Each of them is one more chance for a
 * stranger. Therefore the score of the level rises above ISO_CONFIG_PEOPLE_AT_LEVEL people, by the
 * common logarithm of how many times more there are: 100 people take 1 more, 1,000 take 2 more. So
 * a stranger's visit is let in no more often than the level says, however many people are enrolled.
 * A threshold that is set does not rise. Nor does the score of a method that is not calibrated,
 * because it is not a probability (firmware/recognise/method/method.h).
 *
 * `provisional`: the metric shall adapt to the people and has not done so yet. Scores of real
 * people then promise too much, so the level counts as the next stricter one. */
enum { ISO_CONFIG_PEOPLE_AT_LEVEL = 10 };
double iso_config_threshold_among(const struct iso_config *config, size_t n_people,
                                  bool provisional);

/* The configuration without a file. */
struct iso_config iso_config_default(void);

/* Parses the text of a file; `name` is its name in faults. -EINVAL for anything that is refused,
 * with *out unchanged; -ENOMEM. */
int iso_config_parse(const char *name, const char *text, struct iso_config *out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Reads a file. -ENOENT and other errors of opening and reading it, else the errors of
 * iso_config_parse. */
int iso_config_load(const char *path, struct iso_config *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Lists the options with which the back end of [sensor], or of [door], is opened. They point into
 * the configuration. Returns their number. */
size_t iso_config_sensor_options(const struct iso_config *config,
                                 struct iso_option out[ISO_CONFIG_OPTIONS_MAX]);
size_t iso_config_door_options(const struct iso_config *config,
                               struct iso_option out[ISO_CONFIG_OPTIONS_MAX]);

/* The value of an option of a back end, or "" if it is not set. */
const char *iso_config_option(const struct iso_config_options *options, const char *name);

/* Sets an option for the back end that `config->sensor.backend` names, as a line of a file would.
 * An empty value changes nothing. -EINVAL
 * with a fault that names the option: there is no such option, its value is bad or too long, or
 * there are too many. */
int iso_config_set_sensor_option(struct iso_config *config, const char *name, const char *value,
                                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes a configuration file that names, explains and comments out every key, and the options of
 * every back end of this build. */
void iso_config_print_sample(FILE *out);

#endif
