/* The table of all configuration keys. */
#include "firmware/config/config.h"

#include <string.h>

#define AT(section, field) offsetof(struct iso_config, section.field)

/* The names of the recognition methods, "|a|b", and a line of help for them, both from the list of
 * methods. */
#define METHOD(name, about) "|" #name
static const char method_choices[] =
#include "firmware/recognise/method/methods.def"
    ;
#undef METHOD
#define METHOD(name, about) "; " #name ": " about
static const char method_help[] = "what compares two templates"
#include "firmware/recognise/method/methods.def"
    ;
#undef METHOD

const struct iso_config_key iso_config_keys[] = {
    {"sensor", "backend", ISO_CONFIG_TEXT, AT(sensor, backend), 0, 0, NULL, "replay",
     "driver of the depth sensor"},
    {"sensor", "distance_min_mm", ISO_CONFIG_NUMBER, AT(sensor, distance_min_mm), 100, 10000, NULL,
     "300", "a nose nearer than this is too close"},
    {"sensor", "distance_max_mm", ISO_CONFIG_NUMBER, AT(sensor, distance_max_mm), 100, 10000, NULL,
     "1500", "a nose farther than this is too far"},
    {"sensor", "pause_ms", ISO_CONFIG_COUNT, AT(sensor, pause_ms), 100, 600000, NULL, "900",
     "time after the last frame of a stream after which the door is at fault until the next one"},
    {"sensor", "silence_ms", ISO_CONFIG_COUNT, AT(sensor, silence_ms), 100, 600000, NULL, "5000",
     "time without a frame after which a stream is closed and opened again"},
    {"sensor", "stale_ms", ISO_CONFIG_COUNT, AT(sensor, stale_ms), 100, 600000, NULL, "1000",
     "delay of a frame after which it is ignored: the person may have left"},
    {"sensor", "retry_ms", ISO_CONFIG_COUNT, AT(sensor, retry_ms), 10, 600000, NULL, "500",
     "wait before a lost sensor is opened again; doubles with each failure"},
    {"sensor", "retry_max_ms", ISO_CONFIG_COUNT, AT(sensor, retry_max_ms), 10, 3600000, NULL,
     "30000", "longest such wait"},
    {"sensor", "rest_s", ISO_CONFIG_COUNT, AT(sensor, rest_s), 0, 86400, NULL, "10",
     "time with nobody there after which fewer frames are examined; 0: never"},

    {"door", "backend", ISO_CONFIG_TEXT, AT(door, backend), 0, 0, NULL, "null",
     "driver of the door's lines; null switches nothing"},
    {"door", "cards", ISO_CONFIG_TEXT, AT(door, cards), 0, 0, NULL, "",
     "file with the card number of each person, which is sent to the access controller"},
    {"door", "fail", ISO_CONFIG_CHOICE, AT(door, fail), 0, 0, "secure|safe", "secure",
     "state of the lock without power, and at a fault: secure is locked, safe is open"},
    {"door", "unlock_ms", ISO_CONFIG_COUNT, AT(door, unlock_ms), 100, 600000, NULL, "4000",
     "how long the door stays unlocked"},
    {"door", "relay_pulse_ms", ISO_CONFIG_COUNT, AT(door, relay_pulse_ms), 0, 60000, NULL, "0",
     "length of the relay's pulse; 0: the relay is on as long as the door is unlocked"},
    {"door", "held_ms", ISO_CONFIG_COUNT, AT(door, held_ms), 1000, 3600000, NULL, "30000",
     "how long it may stand open before the buzzer sounds"},
    {"door", "refused_ms", ISO_CONFIG_COUNT, AT(door, refused_ms), 0, 60000, NULL, "2000",
     "how long the red light shows a refusal"},
    {"door", "poll_ms", ISO_CONFIG_COUNT, AT(door, poll_ms), 5, 1000, NULL, "50",
     "how often the inputs of the door are read"},
    {"door", "retry_ms", ISO_CONFIG_COUNT, AT(door, retry_ms), 10, 600000, NULL, "500",
     "wait before lost lines are opened again; doubles with each failure"},
    {"door", "retry_max_ms", ISO_CONFIG_COUNT, AT(door, retry_max_ms), 10, 3600000, NULL, "30000",
     "longest such wait"},

    {"reader", "d0", ISO_CONFIG_TEXT, AT(reader, d0), 0, 0, NULL, "",
     "line D0 of a card reader or keypad (Wiegand), such as gpiochip0:5 active-low pull-up"},
    {"reader", "d1", ISO_CONFIG_TEXT, AT(reader, d1), 0, 0, NULL, "", "line D1 of it"},
    {"reader", "osdp_port", ISO_CONFIG_TEXT, AT(reader, osdp_port), 0, 0, NULL, "",
     "serial line of the RS-485 bus of a card reader or keypad (OSDP), instead of d0 and d1"},
    {"reader", "osdp_address", ISO_CONFIG_COUNT, AT(reader, osdp_address), 0, 126, NULL, "0",
     "address of the reader on that bus"},
    {"reader", "osdp_baud", ISO_CONFIG_CHOICE, AT(reader, osdp_baud), 0, 0,
     "9600|19200|38400|57600|115200", "9600", "speed of that bus"},
    {"reader", "osdp_key", ISO_CONFIG_TEXT, AT(reader, osdp_key), 0, 0, NULL, "",
     "file with the key of the reader; empty: anyone on the wire reads and forges cards and keys"},

    {"panel", "port", ISO_CONFIG_TEXT, AT(panel, port), 0, 0, NULL, "",
     "serial line of the RS-485 bus of an access panel (OSDP), such as /dev/ttyS1"},
    {"panel", "address", ISO_CONFIG_COUNT, AT(panel, address), 0, 126, NULL, "0",
     "address on that bus, until the panel sets another one"},
    {"panel", "baud", ISO_CONFIG_CHOICE, AT(panel, baud), 0, 0, "9600|19200|38400|57600|115200",
     "9600", "speed of that bus, until the panel sets another one"},
    {"panel", "plain", ISO_CONFIG_SWITCH, AT(panel, plain), 0, 0, NULL, "no",
     "cards are sent without the secure channel, too: anyone on the wire reads and forges them"},
    {"panel", "card_bits", ISO_CONFIG_CHOICE, AT(panel, card_bits), 0, 0, "26|34", "26",
     "format of a card number"},

    {"gallery", "path", ISO_CONFIG_TEXT, AT(gallery, path), 0, 0, NULL,
     "/var/lib/isotherm/gallery.db", "people and templates; created if it does not exist"},
    {"gallery", "capacity", ISO_CONFIG_COUNT, AT(gallery, capacity), 1, 100000, NULL, "1000",
     "most people that can be enrolled"},

    {"seal", "key", ISO_CONFIG_TEXT, AT(seal, key), 0, 0, NULL, "",
     "the key of the appliance, if it is not a credential; empty: next to the gallery"},
    {"seal", "counter", ISO_CONFIG_CHOICE, AT(seal, counter), 0, 0, "none|tpm2", "none",
     "counter in a TPM 2.0 that shows when the whole state directory is of an earlier time"},
    {"seal", "counter_tcti", ISO_CONFIG_TEXT, AT(seal, counter_tcti), 0, 0, NULL,
     "device:/dev/tpmrm0", "how that TPM is reached (TCTI)"},
    {"seal", "counter_index", ISO_CONFIG_TEXT, AT(seal, counter_index), 0, 0, NULL, "0x01804953",
     "NV index of the counter, 0x01800000 to 0x01bfffff"},
    {"seal", "migrate", ISO_CONFIG_SWITCH, AT(seal, migrate), 0, 0, NULL, "yes",
     "seal a gallery and a log of the version before, at the first start"},

    {"recognition", "intensity", ISO_CONFIG_CHOICE, AT(recognition, intensity), 0, 0,
     "off|flag|veto", "veto",
     "what happens if an infrared or grey image does not show the face: nothing, a note in "
     "the log, or the frame is not used"},
    {"recognition", "cascade", ISO_CONFIG_TEXT, AT(recognition, cascade), 0, 0, NULL, "",
     "cascade that finds the face in the image; empty: the one of the build"},

    {"match", "method", ISO_CONFIG_CHOICE, AT(match, method), 0, 0, &method_choices[1], "metric",
     method_help},
    {"match", "adapt", ISO_CONFIG_SWITCH, AT(match, adapt), 0, 0, NULL, "yes",
     "adapt the metric to the enrolled people, three or more, so that scores keep their meaning "
     "before this sensor"},
    {"match", "trim", ISO_CONFIG_NUMBER, AT(match, trim), 0.5, 1, NULL, "0.8",
     "share of the points of a template that count in a distance: the closest ones"},
    {"match", "icp_iterations", ISO_CONFIG_COUNT, AT(match, icp_iterations), 1, 100, NULL, "10",
     "steps of the registration of two templates"},
    {"match", "transform", ISO_CONFIG_CHOICE, AT(match, transform), 0, 0, "rigid|affine", "rigid",
     "what the registration may do"},

    {"decision", "level", ISO_CONFIG_CHOICE, AT(decision, level), 0, 0,
     "convenient|balanced|strict", "balanced",
     "share of the visits of strangers that may be let in, however many people are enrolled: 1e-2, "
     "1e-3, 1e-4"},
    {"decision", "threshold", ISO_CONFIG_NUMBER, AT(decision, threshold), -100, 100, NULL, "0",
     "lowest score at which a face is recognised; 0: that of the level, which grows with the "
     "number of "
     "people"},
    {"decision", "margin", ISO_CONFIG_NUMBER, AT(decision, margin), 0, 100, NULL, "0",
     "score by which the best person must lead the second"},
    {"decision", "agree", ISO_CONFIG_COUNT, AT(decision, agree), 2, 32, NULL, "2",
     "frames of one visit that must show the same person, and at least half of all usable ones"},
    {"decision", "max_frames", ISO_CONFIG_COUNT, AT(decision, max_frames), 1, 64, NULL, "6",
     "usable frames after which a visit without agreement is refused"},
    {"decision", "attack_frames", ISO_CONFIG_COUNT, AT(decision, attack_frames), 1, 64, NULL, "2",
     "frames that look like a picture, screen or mask after which a visit is refused"},
    {"decision", "gap_ms", ISO_CONFIG_COUNT, AT(decision, gap_ms), 100, 60000, NULL, "1500",
     "time without a face after which the person has left"},
    {"decision", "refractory_ms", ISO_CONFIG_COUNT, AT(decision, refractory_ms), 100, 600000, NULL,
     "8000", "time after a verdict after which a person who stays is looked at again"},

    {"update", "templates", ISO_CONFIG_COUNT, AT(update, templates), 0, 8, NULL, "0",
     "number of templates to learn of a person at confident matches; 0: none, delete those "
     "learned"},
    {"update", "score", ISO_CONFIG_NUMBER, AT(update, score), -100, 100, NULL, "6",
     "score of a confident match, and of a learned template with the enrolled ones"},

    {"lockout", "failures", ISO_CONFIG_COUNT, AT(lockout, failures), 0, 1000, NULL, "5",
     "strangers refused in a row before the door locks itself for a while; 0 disables this"},
    {"lockout", "attacks", ISO_CONFIG_COUNT, AT(lockout, attacks), 0, 1000, NULL, "3",
     "presentation attacks before the door locks itself; 0 disables this"},
    {"lockout", "first_ms", ISO_CONFIG_COUNT, AT(lockout, first_ms), 1000, 3600000, NULL, "30000",
     "time of the first lock; each later one is twice as long"},
    {"lockout", "longest_ms", ISO_CONFIG_COUNT, AT(lockout, longest_ms), 1000, 86400000, NULL,
     "900000", "longest time of a lock"},
    {"lockout", "forget_ms", ISO_CONFIG_COUNT, AT(lockout, forget_ms), 1000, 86400000, NULL,
     "600000", "time without a refusal or an attack after which all are forgotten"},
    {"lockout", "path", ISO_CONFIG_TEXT, AT(lockout, path), 0, 0, NULL, "",
     "file that keeps the lock over a restart; empty: \"lockout\" next to the audit log"},

    {"policy", "access_point", ISO_CONFIG_TEXT, AT(policy, access_point), 0, 0, NULL, "",
     "access point of the stored policy that this door is; empty: the only one of the policy"},
    {"policy", "factor_ms", ISO_CONFIG_COUNT, AT(policy, factor_ms), 1000, 120000, NULL, "15000",
     "how long the door waits for a card, a PIN or a second person that the policy asks for"},
    {"policy", "card_alone", ISO_CONFIG_SWITCH, AT(policy, card_alone), 0, 0, NULL, "no",
     "whether a card, with the PIN of a person who has one, replaces the face while the sensor "
     "does not work"},

    {"motion", "still_mm_s", ISO_CONFIG_NUMBER, AT(motion, still_mm_s), 1, 100000, NULL, "300",
     "a face that moves faster is ignored until it is still"},
    {"motion", "still_deg_s", ISO_CONFIG_NUMBER, AT(motion, still_deg_s), 1, 100000, NULL, "90",
     "... or that turns faster"},
    {"motion", "jump_mm_s", ISO_CONFIG_NUMBER, AT(motion, jump_mm_s), 1, 1000000, NULL, "2000",
     "a face that seems to move faster is another one"},
    {"motion", "jump_deg_s", ISO_CONFIG_NUMBER, AT(motion, jump_deg_s), 1, 1000000, NULL, "800",
     "... or that seems to turn faster"},
    {"motion", "lifeless_ms", ISO_CONFIG_COUNT, AT(motion, lifeless_ms), 0, 2000, NULL, "1800",
     "time without any movement after which a face is not alive; 0 disables this"},
    {"motion", "frozen_frames", ISO_CONFIG_COUNT, AT(motion, frozen_frames), 0, 64, NULL, "3",
     "identical frames in a row after which they are no measurement; 0 disables this"},

    {"hint", "hold_frames", ISO_CONFIG_COUNT, AT(hint, hold_frames), 1, 8, NULL, "3",
     "how many of the last 8 frames must have the same fault before a hint is given"},
    {"hint", "interval_ms", ISO_CONFIG_COUNT, AT(hint, interval_ms), 0, 60000, NULL, "1000",
     "time between two hints"},

    {"enroll", "stages", ISO_CONFIG_COUNT, AT(enroll, stages), 1, 16, NULL, "4",
     "usable frames of the frontal step of an enrolment"},
    {"enroll", "agree_score", ISO_CONFIG_NUMBER, AT(enroll, agree_score), -100, 100, NULL, "2",
     "score that the frames must have with each other"},
    {"enroll", "duplicate_score", ISO_CONFIG_NUMBER, AT(enroll, duplicate_score), -100, 100, NULL,
     "4", "lowest score with another person at which a face is a duplicate"},
    {"enroll", "yaw_max_deg", ISO_CONFIG_NUMBER, AT(enroll, yaw_max_deg), 1, 90, NULL, "15",
     "a face turned further to a side is not enrolled as a frontal one"},
    {"enroll", "pitch_max_deg", ISO_CONFIG_NUMBER, AT(enroll, pitch_max_deg), 1, 90, NULL, "15",
     "a face that looks further up or down is not enrolled as a frontal one"},
    {"enroll", "coverage_min", ISO_CONFIG_NUMBER, AT(enroll, coverage_min), 0, 1, NULL, "0.8",
     "share of the face that must have been measured"},
    {"enroll", "landmark_coverage_min", ISO_CONFIG_NUMBER, AT(enroll, landmark_coverage_min), 0, 1,
     NULL, "0.5", "share around each landmark that must have been measured"},
    {"enroll", "expression_max", ISO_CONFIG_NUMBER, AT(enroll, expression_max), 0, 100, NULL, "1",
     "a stronger expression (in standard deviations) is not enrolled"},
    {"enroll", "mouth_max_mm", ISO_CONFIG_NUMBER, AT(enroll, mouth_max_mm), 0, 100, NULL, "8",
     "a mouth that is open wider is not enrolled"},
    {"enroll", "timeout_ms", ISO_CONFIG_COUNT, AT(enroll, timeout_ms), 1000, 600000, NULL, "60000",
     "longest enrolment"},
    {"enroll", "pose_stages", ISO_CONFIG_COUNT, AT(enroll, pose_stages), 1, 16, NULL, "2",
     "usable frames of each pose but the frontal one"},
    {"enroll", "pose_timeout_ms", ISO_CONFIG_COUNT, AT(enroll, pose_timeout_ms), 1000, 600000, NULL,
     "10000", "time after which such a pose is left out"},
    {"enroll", "pose_yaw_deg", ISO_CONFIG_NUMBER, AT(enroll, pose_yaw_deg), 5, 40, NULL, "18",
     "how far the head turns to a side for a pose"},
    {"enroll", "pose_pitch_deg", ISO_CONFIG_NUMBER, AT(enroll, pose_pitch_deg), 5, 40, NULL, "15",
     "how far the chin goes down and up for a pose"},
    {"enroll", "pose_within_deg", ISO_CONFIG_NUMBER, AT(enroll, pose_within_deg), 1, 20, NULL, "6",
     "how far from these angles a head may be"},
    {"enroll", "pose_coverage_min", ISO_CONFIG_NUMBER, AT(enroll, pose_coverage_min), 0, 1, NULL,
     "0.7", "share of the face that must have been measured in such a pose"},

    {"log", "path", ISO_CONFIG_TEXT, AT(log, path), 0, 0, NULL, "/var/lib/isotherm/audit.log",
     "the audit log; created if it does not exist"},
    {"log", "sync", ISO_CONFIG_SWITCH, AT(log, sync), 0, 0, NULL, "yes",
     "wait until each record is on the disk"},
    {"log", "max_mib", ISO_CONFIG_COUNT, AT(log, max_mib), 1, 4096, NULL, "64",
     "largest size of the log on the disk; the oldest eighth is deleted when it is full"},
    {"log", "journal", ISO_CONFIG_SWITCH, AT(log, journal), 0, 0, NULL, "yes",
     "also send what records say, without names, to the journal of the system"},

    {"bus", "address", ISO_CONFIG_TEXT, AT(bus, address), 0, 0, NULL, "system",
     "system, session, or the D-Bus address of another bus"},
    {"bus", "action_ms", ISO_CONFIG_COUNT, AT(bus, action_ms), 1000, 600000, NULL, "30000",
     "longest verify or identify of a client"},
    {"bus", "claim_ms", ISO_CONFIG_COUNT, AT(bus, claim_ms), 1000, 3600000, NULL, "60000",
     "a client that holds the camera and does nothing loses it after this time"},

    {"login", "desk", ISO_CONFIG_SWITCH, AT(login, desk), 0, 0, NULL, "no",
     "this machine guards no door: its users may log in by face, which takes the camera meanwhile"},
    {"login", "users", ISO_CONFIG_TEXT, AT(login, users), 0, 0, NULL, "/etc/isotherm/pam-users",
     "file that says which person each user of this machine is; only root may write it"},
    {"login", "longest_ms", ISO_CONFIG_COUNT, AT(login, longest_ms), 1000, 60000, NULL, "15000",
     "longest look for one login"},

    {"reset", "button", ISO_CONFIG_TEXT, AT(reset, button), 0, 0, NULL, "",
     "GPIO line of a button that, held for 10 s while the daemon starts, resets the appliance"},
    {"reset", "credential", ISO_CONFIG_TEXT, AT(reset, credential), 0, 0, NULL,
     "/etc/credstore.encrypted/isotherm.key", "the encrypted key, which a factory reset deletes"},
    {"reset", "web", ISO_CONFIG_TEXT, AT(reset, web), 0, 0, NULL, "/var/lib/isotherm-web",
     "state of the web server, which a factory reset empties"},
    {"reset", "link", ISO_CONFIG_TEXT, AT(reset, link), 0, 0, NULL, "/var/lib/isotherm-link",
     "membership of a fleet, which a factory reset empties"},

    {"fleet", "restart_hours", ISO_CONFIG_TEXT, AT(fleet, restart_hours), 0, 0, NULL, "",
     "hours, in UTC on an image, when an update of the hub may restart it, like 1-5; empty: any"},

    {"process", "confine", ISO_CONFIG_SWITCH, AT(process, confine), 0, 0, NULL, "yes",
     "give up what the daemon does not need of files and system calls (Landlock, seccomp)"},

    {"model", "head", ISO_CONFIG_TEXT, AT(model, head), 0, 0, NULL, "",
     "the head model; the installed one if empty"},
    {"model", "metric", ISO_CONFIG_TEXT, AT(model, metric), 0, 0, NULL, "",
     "the learned metric; the installed one if empty"},
    {"model", "cohort", ISO_CONFIG_TEXT, AT(model, cohort), 0, 0, NULL, "",
     "the cohort that distances are normalised by; the installed one if empty"},
};

const size_t iso_config_n_keys = sizeof iso_config_keys / sizeof *iso_config_keys;

_Static_assert(sizeof iso_config_keys / sizeof *iso_config_keys <= ISO_CONFIG_KEYS_MAX,
               "ISO_CONFIG_KEYS_MAX is too small");

const char *iso_config_find_obsolete(const char *section, const char *name)
{
    return strcmp(section, "process") == 0 && strcmp(name, "threads") == 0 ? "[process] threads"
                                                                           : NULL;
}
