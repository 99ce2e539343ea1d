/* The appliance: everything between a sensor and a door, stepped by an injected clock.
 *
 *   WATCH     people who come to the door are identified; those who are recognised are let in
 *   CLAIMED   a client has the camera, and no action goes on: faces are not looked for
 *   ENROLL, VERIFY, IDENTIFY   a client has the camera, and this action goes on
 *
 * Besides the exit button, only an identification in WATCH and iso_appliance_test_door
 * (administration.h) open the door.
 *
 *   WATCH    claim -> CLAIMED          a visit that has begun is forgotten
 *   CLAIMED  enroll, verify, identify  -> that action
 *            release, or claim_ms without an action -> WATCH
 *   ENROLL, VERIFY, IDENTIFY           stop, or its end -> CLAIMED;  release -> WATCH
 *
 * The door does not depend on the mode: exit button, alarms and times work in each.
 *
 * All calls come from one thread. A step handles at most one frame; it neither sleeps nor waits for
 * the sensor, and takes as long as the work on that frame. With `threads` the door and the log have
 * threads of their own (door_guard.h, audit_writer.h): the door does not wait for a step. A step
 * waits for the disk only for the record of a grant (for a limited time), for enrolled and learned
 * templates, and for the lock-out file. Events are reported from within calls of this header. A
 * handler may call iso_appliance_status, and no other function of this header. */
#ifndef ISO_FIRMWARE_APPLIANCE_APPLIANCE_H
#define ISO_FIRMWARE_APPLIANCE_APPLIANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "drivers/base/times.h"
#include "drivers/door/door_io.h"
#include "drivers/reader/card_source.h"
#include "firmware/access/site_access.h"
#include "firmware/audit/audit.h"
#include "firmware/audit/audit_writer.h"
#include "firmware/config/config.h"
#include "firmware/contract/validity.h"
#include "firmware/door/cards.h"
#include "firmware/door/door_control.h"
#include "firmware/door/door_guard.h"
#include "firmware/gallery/gallery.h"
#include "firmware/panel/panel.h"
#include "firmware/recognise/pipeline.h"
#include "firmware/sensor/sensor_supervisor.h"
#include "firmware/sensor/view.h"
#include "firmware/settings/live_settings.h"
#include "firmware/visit/decision.h"

enum iso_appliance_mode {
    ISO_APPLIANCE_WATCH = 0,
    ISO_APPLIANCE_CLAIMED,
    ISO_APPLIANCE_ENROLL,
    ISO_APPLIANCE_VERIFY,
    ISO_APPLIANCE_IDENTIFY,
    ISO_APPLIANCE_MODES
};

/* "watch", "claimed", "enroll", "verify", "identify"; NULL outside. */
const char *iso_appliance_mode_name(enum iso_appliance_mode mode);

/* A decision of the door, and what the door did. It is reported after the records of both were
 * given to the log. */
struct iso_visit {
    struct iso_verdict verdict;
    enum iso_door_answer door;
    const char *door_fault; /* why the door did not unlock; "" if it did, or was not asked to */
    const char *person;     /* "" when unknown */
    double threshold;
    int64_t latency_ns; /* the time from the arrival of the first usable frame to the verdict */
};

/* A frame, as the people who stand before the sensor may see it. Nothing of it but `frame` and the
 * small differences of a fitted pose tells faces apart. */
struct iso_seen_frame {
    const struct iso_frame *frame;
    const struct iso_rigid *camera_from_face; /* NULL: no face */
    double distance_mm;                       /* of the nose tip; 0: no face */
    enum iso_appliance_mode mode;
    enum iso_capture hint; /* what most of the last frames say; OK: nothing hinders */
    /* The verdict of the visit that goes on, "allow" or "deny", and its reason; "" before that. Or
     * ISO_CONTRACT_VERDICT_WAIT, and what the policy wants besides, ISO_CONTRACT_WANTED_.... */
    const char *verdict, *reason;
    bool lockdown, locked_out;
};

/* The events that the appliance reports; all but the last are REQUIRED. Texts are valid during the
 * call. */
struct iso_appliance_events {
    /* `result` is one of the words ISO_CONTRACT_RESULT_... of firmware/contract/contract.h. The
     * word for a retry is followed by a word of capture.h: a hint, given as hint_filter.h says.
     * person: for a duplicate, the name under which the face is enrolled; for "not-stored", the
     * error of the disk; else "". */
    void (*enroll_status)(void *context, const char *result, bool done, unsigned stage,
                          unsigned stages, double quality, const char *person);
    /* An enrolment with poses: what became of a step. `pose` and `state` are words
     * ISO_CONTRACT_POSE_... and ISO_CONTRACT_STEP_...; step: 1..steps. That the first step has
     * begun is told during iso_appliance_enroll(), before it returns. */
    void (*enroll_step)(void *context, const char *pose, const char *state, unsigned step,
                        unsigned steps, double turn_deg);
    /* mode: VERIFY or IDENTIFY. person: "" when unknown. score: NaN if there is none. */
    void (*recognition_status)(void *context, enum iso_appliance_mode mode, const char *result,
                               bool done, const char *person, double score, double threshold);
    void (*visit)(void *context, const struct iso_visit *visit);
    /* WATCH: the policy wants more of the person at the door: a word ISO_CONTRACT_WANTED_.... */
    void (*wanted)(void *context, const char *what);
    /* WATCH: a hint for the person at the door. */
    void (*hint)(void *context, enum iso_capture capture);
    /* What the sensor sees; only while iso_appliance_aim is on, at most ten times a second. */
    void (*view)(void *context, const struct iso_view *view);
    /* Every frame that is examined, and in CLAIMED every frame; only while
     * iso_appliance_report_frames is on. */
    void (*seen)(void *context, const struct iso_seen_frame *seen);
    /* The frame that iso_appliance_picture asked for, valid during the call. NULL: no picture
     * comes, because the camera shows nothing, the claim has ended or an action begins. */
    void (*picture)(void *context, const struct iso_frame *frame);
    /* Words of door.h. */
    void (*door_changed)(void *context, const char *state, const char *cause);
    /* The claim has ended because its time was over, or with the login that it was for. */
    void (*claim_lost)(void *context);
    /* A line for the system's log; priority as in syslog.h. */
    void (*message)(void *context, int priority, const char *text);
    void *context;
    /* Something waits for isotherm-link: a word ISO_CONTRACT_FLEET_WORK_.... NULL: nobody is told.
     */
    void (*fleet_work)(void *context, const char *what);
};

/* The parts of an appliance. All are borrowed and must outlive it. Nothing else may change
 * pipeline, gallery, audit log and door lines meanwhile. */
struct iso_appliance_borrowed {
    const struct iso_config *config;
    struct iso_times times;
    struct iso_sensor_source sensor;
    struct iso_pipeline pipeline;
    struct iso_door_io *door_io;
    struct iso_door_guard *door; /* of door_io, started already, whose changes nobody has taken yet;
                                  * NULL: the appliance makes one and starts it */
    const struct iso_cards *cards;     /* sent to an access controller; NULL: there is none */
    struct iso_panel *panel;           /* an access panel (panel.h); NULL: there is none */
    struct iso_key_ring *ring;         /* the keys of gallery and log */
    struct iso_state_counter *counter; /* NULL: there is none (state_counter.h) */
    struct iso_card_source reader;     /* of cards and keys (card_source.h) */
    const struct iso_zone_source
        *zones; /* of policies; NULL: none, so that every zone is unknown */
    /* Changes of `config` while the appliance works; NULL: it does not change. */
    struct iso_live_settings *settings;
    const char *lockout_path; /* see lockout_file.h; NULL or "": the state is lost at the end */
    struct iso_gallery *gallery;
    struct iso_audit *audit;
    uint8_t boot_id[16]; /* of this boot of the machine; random if it is not known */
    struct iso_appliance_events events;
    /* True: the door and the log have threads of their own, and `times` must be the clocks of the
     * machine. False: the caller's thread does everything, for a clock that is injected. */
    bool threads;
};

struct iso_appliance;

/* Makes an appliance of these parts; nothing is started yet. -ENOMEM; with threads also -EAGAIN (no
 * thread can be had), or an errno of making descriptors. */
int iso_appliance_new(const struct iso_appliance_borrowed *borrowed, struct iso_appliance **out)
    __attribute__((warn_unused_result));

/* Wipes and frees it and what it holds. NULL is accepted. */
void iso_appliance_free(struct iso_appliance *appliance);

/* Starts the door, then opens the sensor. A missing sensor is not a failure: the appliance tries
 * again, and the door is in FAULT meanwhile. -EINVAL, -ENOENT: the configuration asks for a sensor
 * that cannot exist. -EAGAIN, -ENOMEM: the door gets no thread. */
int iso_appliance_start(struct iso_appliance *appliance, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Does what is due now. Returns the latest time of the next step (ISO_NEVER_NS: no time is set).
 * The next step is due earlier if a descriptor below is readable, or after any other call. */
int64_t iso_appliance_step(struct iso_appliance *appliance);

/* Switches the lines of the door off, and closes the sensor. Records that are still queued are
 * written before iso_appliance_free returns. */
void iso_appliance_stop(struct iso_appliance *appliance);

/* Descriptors that poll readable when a step has something to do; negative if there is none now.
 * The descriptor of the sensor may change with every step; -EAGAIN: it is the same as before, and
 * is not to be watched until the next step. */
int iso_appliance_sensor_fd(const struct iso_appliance *appliance);
int iso_appliance_door_fd(const struct iso_appliance *appliance);
int iso_appliance_panel_fd(const struct iso_appliance *appliance);
int iso_appliance_reader_fd(const struct iso_appliance *appliance);

/* Counts signs of life of the sensor: frames, answers of an idle sensor, attempts to open a lost
 * one. The watchdog is notified only when this number has risen. */
uint64_t iso_appliance_progress(const struct iso_appliance *appliance);

/* ---- what a client can ask for ---- */

/* Takes the claim: WATCH -> CLAIMED. -EBUSY a client has it already. */
int iso_appliance_claim(struct iso_appliance *appliance) __attribute__((warn_unused_result));

/* Gives the claim back, and ends an action without a status. Does nothing in WATCH. */
void iso_appliance_release(struct iso_appliance *appliance);

struct iso_enroll_request {
    const char *person;
    /* A limit that is not named stays as it is stored; a new person has none. */
    struct iso_validity_change validity;
    bool allow_duplicate;
    bool poses; /* a template of each pose (firmware/recognise/enroll_pose.h), not only frontal */
};

/* Begins an action. Errors of all three, each with a fault: -EACCES not claimed, -EBUSY an action
 * goes on, -ENODEV no sensor, -EIO the gallery is out of service. Enroll: -EINVAL bad name or
 * limits, -EDQUOT no room. Verify and identify: -EPERM locked out or lockdown. Verify: -ENOENT no
 * such person, -EINVAL all templates of this person are of another algorithm. */
int iso_appliance_enroll(struct iso_appliance *appliance, const struct iso_enroll_request *request,
                         struct iso_fault *fault) __attribute__((warn_unused_result));
int iso_appliance_verify(struct iso_appliance *appliance, const char *person,
                         struct iso_fault *fault) __attribute__((warn_unused_result));
int iso_appliance_identify(struct iso_appliance *appliance, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Takes the claim, verifies a person for a login of this machine, and gives the claim back by
 * itself at the end: after the last status it reports claim_lost. It ends after [login] longest_ms
 * at the latest. Returns the errors of iso_appliance_verify(). Returns also -EOPNOTSUPP if the
 * appliance guards a door ([login] desk), -EBUSY if another client has the claim, and -EPERM if the
 * person is not valid now. After an error nothing has changed. */
int iso_appliance_verify_login(struct iso_appliance *appliance, const char *person,
                               struct iso_fault *fault) __attribute__((warn_unused_result));

/* Ends an action of this kind without a status, or acknowledges an action that has ended by itself.
 * -ENODATA there is none. */
int iso_appliance_stop_action(struct iso_appliance *appliance, enum iso_appliance_mode mode)
    __attribute__((warn_unused_result));

/* Deletes a person, and records it. -ENOENT, or an error of gallery or log. */
int iso_appliance_remove(struct iso_appliance *appliance, const char *person,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* Clears failures and attacks, which ends a lock (lockout.h), and records it. Also accepts the date
 * of a clock that is behind the log. After an error of the log or of the lock-out file nothing has
 * changed. -EIO while the lock-out file cannot be read. */
int iso_appliance_clear_lockout(struct iso_appliance *appliance, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Begins or ends the lockdown, in which nobody is let in, and records it. After an error of the log
 * or of the lock-out file, a lockdown does not end. A lockdown begins in spite of such an error,
 * which is returned. */
int iso_appliance_lockdown(struct iso_appliance *appliance, bool on, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* WATCH: somebody showed a card to a reader, or pressed a key ('0' to '9', '*', '#') of a keypad.
 * Without a policy, and while nobody is let in, neither counts. */
void iso_appliance_card(struct iso_appliance *appliance, const struct iso_card_number *card);
void iso_appliance_key(struct iso_appliance *appliance, char key);

/* Turns the event `view` on or off, in every mode that examines frames. Nothing else changes: the
 * door stays in service. */
void iso_appliance_aim(struct iso_appliance *appliance, bool on);
bool iso_appliance_is_aimed(const struct iso_appliance *appliance);

/* Turns the event `seen` on or off. Nothing else changes. */
void iso_appliance_report_frames(struct iso_appliance *appliance, bool on);

/* Records that the client that has the claim begins to watch the relief of the frames. -EACCES not
 * claimed, or an error of the log; then the client must not get them. */
int iso_appliance_record_relief(struct iso_appliance *appliance, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Records that a client acts for an account of its own, before it does so. `person` is the person
 * concerned, or "". An error of the log; then the client must not act. */
int iso_appliance_record_act(struct iso_appliance *appliance, const char *person, const char *note,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

/* Asks for the next frame, once. The event `picture` brings it, or reports within three seconds
 * that no picture comes. The request is recorded. -EACCES not claimed, -EBUSY an action goes on or
 * the last picture is still awaited, -ENODEV no sensor, or an error of the log; then there is no
 * event. */
int iso_appliance_picture(struct iso_appliance *appliance, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The log. Hold it to read it (audit_writer.h). */
struct iso_audit_writer *iso_appliance_log(const struct iso_appliance *appliance);

/* Counts since the start. */
struct iso_appliance_counts {
    uint64_t allowed, denied; /* visits */
    uint64_t attacks;         /* visits denied for ISO_REASON_ATTACK */
    uint64_t attack_frames;   /* frames with a cue of an attack, in all modes */
};

struct iso_appliance_status {
    enum iso_appliance_mode mode;
    enum iso_door_state door;
    /* A code is ISO_FAULT_NONE if there is no fault or if the fault has no code. */
    char door_fault[256]; /* why the door's lines do not work; "" while they do */
    enum iso_fault_code door_fault_code;
    bool door_ordinary;                          /* the door's thread has no real-time priority */
    const char *sensor_state;                    /* "started", "silent", "repeats", "lost" */
    const char *sensor_model;                    /* "" while unknown */
    const char *sensor_calibration;              /* "" while unknown, or if it has none */
    enum iso_fault_code sensor_calibration_code; /* why the calibration is not reliable */
    const char *sensor_fault;                    /* the last fault; "" if there was none */
    enum iso_fault_code sensor_fault_code;
    const char *clock_fault;              /* the clock was set back; "" while it is right */
    enum iso_fault_code clock_fault_code; /* also for a clock that is not set, which has no text */
    const char *stale_fault; /* grants have hardly enough time (stale_budget.h); else "" */
    enum iso_fault_code stale_fault_code;
    const char *storage_fault; /* the last error of the disk; "" once it works again */
    enum iso_fault_code storage_fault_code;
    const char *counter_fault; /* a fault of the counter of the state; "" while it works */
    enum iso_fault_code counter_fault_code;
    char sensor_health[64]; /* what its driver reports; "" while all is well */
    enum iso_fault_code sensor_health_code;
    size_t people_valid; /* people who may come in at this time */
    /* Of the last visit, such as "allow anna" or "deny"; "" before the first. If the door did not
     * unlock, ", door not-unlocked" follows the name. */
    const char *last_outcome;
    const char *image_check;     /* "off", "flag", "veto", "absent" (pipeline.h) */
    const struct iso_view *view; /* the last frame that was examined; NULL: there was none */
    struct iso_appliance_counts counts;
    const char *reader_state; /* of the card reader: "off", "works", "lost" */
    const char *reader_fault; /* why it does not work; "" if it does, or if there is none */
    bool key_is_credential;   /* of the service manager; false: it is a file */
    bool lockdown;
    int64_t lockout_ns; /* how long nobody is let in; 0: not locked out */
    uint64_t frames;
    uint32_t model, algorithm;
    int64_t uptime_ns;
};

/* The present state. Its texts belong to the appliance and are valid until the next call. */
struct iso_appliance_status iso_appliance_status(const struct iso_appliance *appliance);

#endif
