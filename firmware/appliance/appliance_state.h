/* The state of an appliance. Internal to firmware/appliance.
 *
 * Members that change together are one struct. The file named beside a struct is its owner. Only
 * the owner writes the struct; the other files read it or call a function of the owner
 * (appliance_calls.h). */
#ifndef ISO_FIRMWARE_APPLIANCE_APPLIANCE_STATE_H
#define ISO_FIRMWARE_APPLIANCE_APPLIANCE_STATE_H

#include <pthread.h>

#include "core/find/scene_motion.h"
#include "core/presentation/frame_memory.h"
#include "core/presentation/liveness.h"
#include "firmware/access/factor_wait.h"
#include "firmware/appliance/appliance.h"
#include "firmware/audit/audit_writer.h"
#include "firmware/door/door_events.h"
#include "firmware/door/door_guard.h"
#include "firmware/recognise/enrolment.h"
#include "firmware/recognise/image_tally.h"
#include "firmware/recognise/track.h"
#include "firmware/sensor/rest.h"
#include "firmware/visit/attack_tally.h"
#include "firmware/visit/hint_filter.h"
#include "firmware/visit/lockout.h"
#include "firmware/visit/repeat_watch.h"
#include "firmware/visit/stale_budget.h"
#include "firmware/visit/suspension.h"

struct iso_fleet;

/* The sensor. (appliance_sensor.c) */
struct iso_appliance_sensor {
    struct iso_sensor_supervisor supervisor;
    int64_t look_due_ns; /* the next time to look at the sensor; ISO_NEVER_NS: not known */
    bool blind;          /* the door is at fault because the sensor sees nothing */
};

/* Whether usable frames repeat earlier ones. (appliance_repeat.c) */
struct iso_appliance_repeats {
    struct iso_frame_memory *shown; /* usable frames of the last ten minutes */
    struct iso_repeat_watch watch;
};

/* The frame in work, and the face in it. (appliance_face.c; appliance_learn.c marks the template as
 * a learned one while the gallery stores it) */
struct iso_appliance_face {
    struct iso_extraction extraction; /* its template is wiped after the frame */
    bool complaining; /* the last frame failed, so the next failure is not reported again */
    struct iso_track track;
    struct iso_track_motion motion; /* all zero without a fitted face */
    struct iso_liveness liveness;
    uint64_t liveness_track; /* the value of motion.track whose frames `liveness` holds */
    struct iso_scene_motion scene_motion;
    bool moves; /* something moved lately, by scene_motion */
    struct iso_rest rest;
    bool slowed; /* the sensor was asked for fewer frames */
};

/* The results of the frames of a visit, or of a client's action. (appliance_frame.c) */
struct iso_appliance_visit {
    struct iso_decision decision;
    int64_t arrival_ns; /* arrival of the first usable frame */
    struct iso_image_tally image;
    struct iso_hint_filter hints;
    struct iso_attack_tally attacks;
};

/* The outcome of visits. (verdict/verdict_finish.c) */
struct iso_appliance_outcome {
    char text[48 + ISO_PERSON_NAME_SIZE]; /* of the last visit, for the status */
    char person[ISO_PERSON_NAME_SIZE];    /* the person whom the text names; "": nobody */
    struct iso_fault card_fault;          /* why the last card number was not sent */
    struct iso_door_look door_look;       /* the door after the last grant */
    struct iso_verdict verdict;           /* of the last visit */
    struct iso_appliance_counts counts;
};

/* Changes of the door that are still to be recorded or reported. (appliance_door.c) */
struct iso_appliance_door_news {
    pthread_mutex_t mutex; /* protects `recorded`, which the thread of the door uses, too */
    struct iso_door_events recorded;
    struct iso_door_events reported; /* the same for the reports to people */
};

/* What the access panel shows at the door. (appliance_door.c) */
struct iso_appliance_panel {
    struct iso_door_lamps lamps; /* as they were shown last */
    int64_t due_ns;              /* when to look at the panel again */
};

/* The policy, and the people who still have to show more. (appliance_access.c) */
struct iso_appliance_access {
    struct iso_site_access *site;
    struct iso_factor_wait wait;
    struct iso_verdict verdict;    /* of the last face that was recognised while waiting */
    bool duress;                   /* the duress PIN of this wait is on record */
    struct iso_fault reader_fault; /* of the card reader, as it was reported last */
};

/* Refusals of everybody, whatever the face. (appliance_refusal.c) */
struct iso_appliance_lockout {
    struct iso_lockout state;
    int64_t save_ns;        /* when to try again to write the file; ISO_NEVER_NS: never */
    int64_t read_ns;        /* when to try again to read the file; ISO_NEVER_NS: never */
    struct iso_fault fault; /* why the file could not be read */
};

/* The state of the disk. (appliance_storage.c) */
struct iso_appliance_storage {
    struct iso_fault fault;   /* the last error of the disk; "" once it works again */
    int log_error;            /* error of the last posted record, as far as is known */
    int64_t gallery_retry_ns; /* the next attempt to read the gallery while it is lost */
};

/* Whether a grant has enough time. (appliance_stale.c) */
struct iso_appliance_stale {
    struct iso_stale_budget budget;
    struct iso_fault fault; /* the needed time is close to stale_ms; "": it is not */
    bool told;              /* a warning was written since the sensor was opened */
};

/* The counter of the state directory. (appliance_storage.c) */
struct iso_appliance_counter {
    struct iso_fault fault; /* "" while it works */
    bool due;               /* its number has to be raised */
    int64_t due_ns;         /* since when it has to be raised */
    bool noted;             /* a record was written for that */
};

/* The view for the person who aims the sensor. (appliance_status.c) */
struct iso_appliance_aim {
    bool on;
    bool has_view;
    struct iso_view view; /* the view of the last frame */
    int64_t told_ns;
};

/* The client that has the camera. (appliance_action.c, which also writes `mode`) */
struct iso_appliance_claim {
    int64_t deadline_ns;           /* the end of the claim, or of the action */
    enum iso_appliance_mode ended; /* the action that ended by itself; CLAIMED: none */
    struct iso_person person;      /* VERIFY: the person who is to be verified */
    bool login;                    /* the claim lasts no longer than this one VERIFY */
};

/* ENROLL. (appliance_enroll.c) */
struct iso_appliance_enrolling {
    struct iso_person person;            /* the person who is to be enrolled */
    struct iso_validity_change validity; /* the limits that were named */
    struct iso_enrolment enrolment;
};

/* The frames that clients see. (appliance_picture.c) */
struct iso_appliance_picture {
    bool reports;   /* every frame is reported */
    bool due;       /* the next frame is the picture that a client waits for */
    int64_t end_ns; /* the end of the wait */
};

/* The fleet to which the door belongs. (administration/fleet.c) */
struct iso_appliance_fleet {
    struct iso_fleet *door; /* NULL: the gallery could not be read yet */
    int64_t due_ns;         /* when to look at it again, by the clock of the steps */
};

struct iso_appliance {
    /* The parts of the appliance, set once. (appliance.c; `door`: appliance_door.c;
     * `borrowed.lockout_path`: appliance_refusal.c makes "" of NULL) */
    struct iso_appliance_borrowed borrowed;
    struct iso_audit_writer *log;
    struct iso_door_guard *door;
    int64_t start_ns;

    enum iso_appliance_mode mode;
    struct iso_suspension suspension; /* (appliance.c) */
    struct iso_appliance_sensor sensor;
    struct iso_appliance_repeats repeats;
    struct iso_appliance_face face;
    struct iso_appliance_visit visit;
    struct iso_appliance_outcome outcome;
    struct iso_appliance_door_news door_news;
    struct iso_appliance_panel panel;
    struct iso_appliance_access access;
    struct iso_appliance_fleet fleet;
    struct iso_appliance_lockout lockout;
    struct iso_appliance_storage storage;
    struct iso_fault clock_fault; /* the clock was set back; "": it was not (appliance_clock.c) */
    struct iso_appliance_stale stale;
    struct iso_appliance_counter counter;
    struct iso_appliance_aim aim;
    struct iso_appliance_claim claim;
    struct iso_appliance_enrolling enrolling;
    struct iso_appliance_picture picture;
    int site_error; /* the last error of adapting the metric that was reported (appliance_learn.c)
                     */
};

#endif
