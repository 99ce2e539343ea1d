/* A stand-in for the daemon. It has the name, object and interface of firmware/contract/contract.h,
 * keeps to the signatures written there, and follows a script. It runs in a process of its own. As
 * in the daemon, an action without a claim, a second claim, and a stop without a start fail. */
#ifndef TEST_FAKE_DAEMON_H
#define TEST_FAKE_DAEMON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* One status signal. It is sent after EnrollStart, VerifyStart or IdentifyStart, in the form of
 * that action. A result that begins with "step-" is sent as EnrollStep: with the state that
 * follows, stage and stages as the step and the number of steps, value as the angle, and person as
 * the pose. */
struct fake_status {
    const char *result;
    bool done;
    unsigned stage, stages; /* of an enrolment */
    double value;           /* the quality, or the score */
    /* The person verified or identified, or the duplicate of an enrolment; NULL: "". */
    const char *person;
    double threshold;
};

/* One View signal, sent to the client that calls AimStart. */
struct fake_view {
    const char *capture;
    double distance_mm, yaw_deg; /* NAN: the signal leaves it out */
};

/* One Progress signal. The caller of a long method gets it before the answer, `after_ms` after the
 * call or after the previous signal. */
struct fake_progress {
    uint64_t done, total;
    unsigned after_ms;
};

struct fake_person {
    const char *name;
    int64_t enrolled, valid_from, valid_until;
    uint32_t templates;
};

struct fake_script {
    const char *fail_method, *fail_error; /* the method that fails, and its D-Bus error */
    const struct fake_status *statuses;
    size_t n_statuses;
    const struct fake_view *views;
    size_t n_views;
    const char *fail_text; /* text of that error; NULL: "the fake says so" */
    bool vanish;           /* it leaves the bus after the last status or view */
    const char *stranger;  /* another connection sends this result as final, before the statuses */
    const struct fake_progress *progress; /* of ExportPeople, ImportPeople, RotateKeys, VerifyLog */
    size_t n_progress;
    unsigned answer_ms; /* these methods answer this long after the last of these signals */
    const struct fake_person *people;
    size_t n_people;
    const char *remark;                                         /* of RenamePerson; NULL: "" */
    const char *sensor_fault, *sensor_calibration, *door_lines; /* NULL: "" */
    const char *sensor_devices;                                 /* NULL: "" */
    const char *sensor_state, *door_state, *model, *version;    /* NULL: all is well */
    const char *counter_fault, *panel_fault;                    /* NULL: "" */
    const char *storage_fault;                                  /* NULL: "" */
    const char *stale_fault;                                    /* NULL: "" */
    bool door_ordinary;                                         /* "door-realtime" is false */
    const char *sensor_health, *clock_fault;                    /* NULL: "" */
    const char *sensor_fault_code, *sensor_health_code, *sensor_devices_code; /* NULL: "" */
    const char *sensor_calibration_code, *door_fault_code, *storage_fault_code, *clock_fault_code;
    const char *stale_fault_code, *counter_fault_code, *panel_fault_code;
    const char *door, *door_fault; /* of the lines; NULL: "gpiod", "" */
    unsigned n_records;            /* number of records in the log, numbered from 1 */
    const char *last_record;       /* its members from "event" on; NULL: like the other records */
    /* Each ReadLog adds so many records and removes so many of the oldest. */
    unsigned records_come, records_go;
    const char *picture;      /* content of the file that Picture returns; NULL: "PNG" */
    size_t picture_size;      /* its length in bytes; 0: up to the NUL */
    const char *site;         /* the word of "site"; NULL: "off" */
    uint32_t site_people;     /* people that the metric of the site has learned from */
    uint32_t site_other;      /* people who were enrolled before another class of sensor */
    bool site_estimated;      /* GetSite has error rates, and anna and Bo Ek look alike */
    const char *policy;       /* the document that is stored; NULL: "" */
    uint64_t policy_revision; /* SetPolicy returns the revision that it is given plus 1 */
    const char *policy_remark, *finding; /* of SetPolicy and CheckPolicy; NULL: none */
    const char *outcome, *reason; /* of TestAccess; NULL: "allow", "". "want" wants card, pin */
    bool companion;               /* "want" wants a second person, too */
    const char *credential;       /* of GetCredential and SetCredential; NULL: one with nothing */
    const char *key_place;        /* NULL: GetStatus does not have it */
    bool frames_come;             /* 30 frames a second between two calls of GetStatus */
    const char *commissioned;     /* the outcome that RecordCommission returns; NULL: "passed" */
    unsigned refused;             /* the first calls of ReadLog, so many, fail with TooManyCalls */
};

struct fake_daemon {
    pid_t pid;
    int trace_fd;
};

/* Returns when the service is on the bus. */
void fake_daemon_start(struct fake_daemon *daemon, const char *address,
                       const struct fake_script *script);

/* Ends the service and returns the calls that it received, such as "Claim;EnrollStart anna;...".
 * The options of an enrolment or of limits are written as name=value after the person. The text is
 * valid until the next call. */
const char *fake_daemon_stop(struct fake_daemon *daemon);

#endif
