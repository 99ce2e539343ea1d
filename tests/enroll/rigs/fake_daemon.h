/* A stand-in for the daemon: it has the name, object and interface of firmware/contract/contract.h,
 * keeps to the signatures written there, and does what a script says. It runs in a process of its
 * own. Stricter than the daemon: an action without a claim, a second claim and a stop without a
 * start fail. */
#ifndef TEST_FAKE_DAEMON_H
#define TEST_FAKE_DAEMON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* One status signal, sent after EnrollStart, VerifyStart or IdentifyStart in the form of that
 * action. */
struct fake_status {
    const char *result;
    bool done;
    unsigned stage, stages; /* enrolment */
    double value;           /* the quality, or the score */
    const char *person;     /* verify, identify; enroll: a duplicate's; NULL: "" */
    double threshold;
};

/* One View signal, sent to who calls AimStart. */
struct fake_view {
    const char *capture;
    double distance_mm, yaw_deg; /* NAN: left out */
};

/* One Progress signal, sent to the caller of a long method before its answer, `after_ms` after the
 * call or the signal before it. */
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
    const char *fail_method, *fail_error; /* the method that fails, with which D-Bus error */
    const struct fake_status *statuses;
    size_t n_statuses;
    const struct fake_view *views;
    size_t n_views;
    const char *fail_text; /* what the error says; NULL: "the fake says so" */
    bool vanish;           /* leave the bus after the last status */
    const char *stranger;  /* another connection sends this result, as done, before the statuses */
    const struct fake_progress *progress; /* of ExportPeople, ImportPeople, RotateKeys, VerifyLog */
    size_t n_progress;
    unsigned answer_ms; /* how long after the last of them these methods answer */
    const struct fake_person *people;
    size_t n_people;
    const char *remark;                                         /* of RenamePerson; NULL: "" */
    const char *sensor_fault, *sensor_calibration, *door_lines; /* NULL: "" */
    const char *sensor_devices;                                 /* NULL: none are told of */
    const char *sensor_state, *door_state, *model, *version;    /* NULL: all is well */
    const char *counter_fault;                                  /* NULL: "" */
    const char *storage_fault;                                  /* NULL: "" */
    const char *stale_fault;                                    /* NULL: "" */
    bool door_ordinary;                                         /* "door-realtime" is false */
    const char *sensor_health, *clock_fault;                    /* NULL: "" */
    const char *sensor_fault_code, *sensor_health_code, *sensor_devices_code; /* NULL: "" */
    const char *sensor_calibration_code, *door_fault_code, *storage_fault_code, *clock_fault_code;
    const char *stale_fault_code, *counter_fault_code;
    const char *door, *door_fault; /* back end and its lines, so too */
    unsigned n_records;            /* in the log, numbered from 1 */
    const char *last_record;       /* its members from "event" on; NULL: like the others */
    /* With every ReadLog so many more come, and so many of the oldest go. */
    unsigned records_come, records_go;
    const char *picture; /* the bytes of the file that Picture gives, up to a NUL; NULL: "PNG" */
    size_t picture_size; /* how many they are; 0: up to a NUL */
    unsigned refused;    /* so many of the first calls of ReadLog are too many */
};

struct fake_daemon {
    pid_t pid;
    int trace_fd;
};

/* Returns when the service is on the bus. */
void fake_daemon_start(struct fake_daemon *daemon, const char *address,
                       const struct fake_script *script);

/* Ends it and returns the calls it got, "Claim;EnrollStart anna;..."; options of an enrolment
 * or of limits are written as name=value after the person. Valid until the next call. */
const char *fake_daemon_stop(struct fake_daemon *daemon);

#endif
