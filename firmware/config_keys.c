/* The table of all configuration keys. */
#include "firmware/config.h"

#define AT(section, field) offsetof(struct iso_config, section.field)

const struct iso_config_key iso_config_keys[] = {
    {"sensor", "backend", ISO_CONFIG_TEXT, false, AT(sensor, backend), 0, 0, NULL, "replay",
     "driver of the depth sensor"},
    {"sensor", "path", ISO_CONFIG_TEXT, true, AT(sensor, path), 0, 0, NULL, "",
     "replay: the recording, or a symbolic link to one"},
    {"sensor", "pace", ISO_CONFIG_TEXT, true, AT(sensor, pace), 0, 0, NULL, "",
     "replay: realtime, or asap"},
    {"sensor", "loop", ISO_CONFIG_TEXT, true, AT(sensor, loop), 0, 0, NULL, "",
     "replay: yes begins again after the last frame"},
    {"sensor", "distance_min_mm", ISO_CONFIG_NUMBER, false, AT(sensor, distance_min_mm), 100, 10000,
     NULL, "300", "a nose nearer than this is too close"},
    {"sensor", "distance_max_mm", ISO_CONFIG_NUMBER, false, AT(sensor, distance_max_mm), 100, 10000,
     NULL, "1500", "a nose farther than this is too far"},
    {"sensor", "silence_ms", ISO_CONFIG_COUNT, false, AT(sensor, silence_ms), 100, 600000, NULL,
     "5000", "a stream without a frame for so long is broken and opened anew"},
    {"sensor", "retry_ms", ISO_CONFIG_COUNT, false, AT(sensor, retry_ms), 10, 600000, NULL, "500",
     "wait before a lost sensor is opened again; doubles with each failure"},
    {"sensor", "retry_max_ms", ISO_CONFIG_COUNT, false, AT(sensor, retry_max_ms), 10, 3600000, NULL,
     "30000", "longest such wait"},

    {"door", "backend", ISO_CONFIG_TEXT, false, AT(door, backend), 0, 0, NULL, "null",
     "driver of the door's lines; null switches nothing"},
    {"door", "inputs", ISO_CONFIG_TEXT, true, AT(door, inputs), 0, 0, NULL, "",
     "null: a file with the levels of the inputs"},
    {"door", "fail", ISO_CONFIG_CHOICE, false, AT(door, fail), 0, 0, "secure|safe", "secure",
     "lock without power, and at a fault: secure is locked, safe is open"},
    {"door", "unlock_ms", ISO_CONFIG_COUNT, false, AT(door, unlock_ms), 100, 600000, NULL, "4000",
     "how long the door is unlocked for somebody to open it"},
    {"door", "held_ms", ISO_CONFIG_COUNT, false, AT(door, held_ms), 1000, 3600000, NULL, "30000",
     "how long it may stand open before the buzzer sounds"},
    {"door", "refused_ms", ISO_CONFIG_COUNT, false, AT(door, refused_ms), 0, 60000, NULL, "2000",
     "how long the red light shows a refusal"},
    {"door", "poll_ms", ISO_CONFIG_COUNT, false, AT(door, poll_ms), 5, 1000, NULL, "50",
     "how often the door's inputs are looked at"},

    {"gallery", "path", ISO_CONFIG_TEXT, false, AT(gallery, path), 0, 0, NULL,
     "/var/lib/isotherm/gallery.db", "people and templates; made if it does not exist"},
    {"gallery", "capacity", ISO_CONFIG_COUNT, false, AT(gallery, capacity), 1, 100000, NULL, "1000",
     "most people that can be enrolled"},

    {"match", "trim", ISO_CONFIG_NUMBER, false, AT(match, trim), 0.5, 1, NULL, "0.8",
     "share of a template's points that counts, the closest ones"},
    {"match", "icp_iterations", ISO_CONFIG_COUNT, false, AT(match, icp_iterations), 1, 100, NULL,
     "10", "steps of the registration of two templates"},
    {"match", "transform", ISO_CONFIG_CHOICE, false, AT(match, transform), 0, 0, "rigid|affine",
     "rigid", "what the registration may do"},

    {"decision", "threshold", ISO_CONFIG_NUMBER, false, AT(decision, threshold), -100, 100, NULL,
     "0.62", "score from which on a face is taken for a person's"},
    {"decision", "margin", ISO_CONFIG_NUMBER, false, AT(decision, margin), 0, 100, NULL, "0",
     "score by which the best person must lead the second"},
    {"decision", "agree", ISO_CONFIG_COUNT, false, AT(decision, agree), 1, 32, NULL, "2",
     "frames of one visit that must show the same person"},
    {"decision", "max_frames", ISO_CONFIG_COUNT, false, AT(decision, max_frames), 1, 64, NULL, "6",
     "usable frames after which a visit without agreement is refused"},
    {"decision", "gap_ms", ISO_CONFIG_COUNT, false, AT(decision, gap_ms), 100, 60000, NULL, "1500",
     "who is not seen for so long has left"},
    {"decision", "refractory_ms", ISO_CONFIG_COUNT, false, AT(decision, refractory_ms), 100, 600000,
     NULL, "8000", "who stays after a verdict is looked at again after this time"},

    {"enroll", "stages", ISO_CONFIG_COUNT, false, AT(enroll, stages), 1, 16, NULL, "4",
     "usable frames that make an enrolment"},
    {"enroll", "agree_score", ISO_CONFIG_NUMBER, false, AT(enroll, agree_score), -100, 100, NULL,
     "0.4", "score that the frames must have with each other"},
    {"enroll", "duplicate_score", ISO_CONFIG_NUMBER, false, AT(enroll, duplicate_score), -100, 100,
     NULL, "0.62", "score with somebody else from which on a face is a duplicate"},
    {"enroll", "timeout_ms", ISO_CONFIG_COUNT, false, AT(enroll, timeout_ms), 1000, 600000, NULL,
     "60000", "longest enrolment"},

    {"log", "path", ISO_CONFIG_TEXT, false, AT(log, path), 0, 0, NULL,
     "/var/lib/isotherm/audit.log", "the audit log; made if it does not exist"},
    {"log", "sync", ISO_CONFIG_SWITCH, false, AT(log, sync), 0, 0, NULL, "yes",
     "wait until each record is on the disk"},

    {"bus", "address", ISO_CONFIG_TEXT, false, AT(bus, address), 0, 0, NULL, "system",
     "system, session, or the D-Bus address of another bus"},
    {"bus", "action_ms", ISO_CONFIG_COUNT, false, AT(bus, action_ms), 1000, 600000, NULL, "30000",
     "longest verify or identify of a client"},
    {"bus", "claim_ms", ISO_CONFIG_COUNT, false, AT(bus, claim_ms), 1000, 3600000, NULL, "60000",
     "a client that holds the camera and does nothing loses it after this time"},

    {"model", "head", ISO_CONFIG_TEXT, false, AT(model, head), 0, 0, NULL, "",
     "the head model; the installed one if empty"},
    {"model", "cohort", ISO_CONFIG_TEXT, false, AT(model, cohort), 0, 0, NULL, "",
     "the cohort that scores are normalised by; the installed one if empty"},
};

const size_t iso_config_n_keys = sizeof iso_config_keys / sizeof *iso_config_keys;

_Static_assert(sizeof iso_config_keys / sizeof *iso_config_keys <= ISO_CONFIG_KEYS_MAX,
               "ISO_CONFIG_KEYS_MAX is too small");
