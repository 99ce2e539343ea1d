/* What an appliance holds, and what its parts are called. Internal to firmware/appliance. */
#ifndef ISO_FIRMWARE_APPLIANCE_APPLIANCE_STATE_H
#define ISO_FIRMWARE_APPLIANCE_APPLIANCE_STATE_H

#include <pthread.h>

#include "core/find/scene_motion.h"
#include "core/presentation/frame_memory.h"
#include "core/presentation/liveness.h"
#include "firmware/appliance/appliance.h"
#include "firmware/audit/audit_writer.h"
#include "firmware/contract/fault_tag.h"
#include "firmware/door/door_events.h"
#include "firmware/door/door_guard.h"
#include "firmware/recognise/enrolment.h"
#include "firmware/recognise/image_tally.h"
#include "firmware/recognise/track.h"
#include "firmware/visit/attack_tally.h"
#include "firmware/visit/hint_filter.h"
#include "firmware/visit/lockout.h"
#include "firmware/visit/repeat_watch.h"
#include "firmware/visit/stale_budget.h"
#include "firmware/visit/suspension.h"

struct iso_appliance {
    struct iso_appliance_borrowed borrowed;
    struct iso_sensor_supervisor supervisor;
    int64_t look_due_ns; /* when the sensor has to be looked at next; ISO_NEVER_NS: not known */
    bool blind;          /* the door is at fault because the sensor sees nothing */
    struct iso_door_guard *door;
    pthread_mutex_t recorded_mutex;  /* of `recorded`, which the door's thread has, too */
    struct iso_door_events recorded; /* changes of the door as they are put on record */
    struct iso_door_events reported; /* the same as people see them */
    struct iso_audit_writer *log;
    int log_error; /* of the last posted record, as far as is known */
    struct iso_suspension suspension;
    int64_t start_ns;
    enum iso_appliance_mode mode;

    struct iso_extraction extraction; /* of the frame worked on; the template is wiped after it */
    bool complaining; /* the last frame failed: the next failure is not told again */
    struct iso_track track;
    struct iso_liveness liveness;
    uint64_t liveness_track;         /* of motion.track, whose frames it holds */
    struct iso_frame_memory *shown;  /* the frames that were evidence */
    struct iso_repeat_watch repeats; /* whether usable frames repeat earlier ones */
    struct iso_track_motion motion;  /* of the frame worked on; all zero without a fitted face */
    struct iso_scene_motion scene_motion;
    struct iso_hint_filter hints;
    struct iso_attack_tally attacks;
    bool aimed;
    bool has_view;
    struct iso_view view; /* of the last frame */
    int64_t view_told_ns;

    /* WATCH, VERIFY, IDENTIFY */
    struct iso_decision decision;
    int64_t arrival_ns;             /* of the first usable frame */
    struct iso_image_tally image;   /* of the visit */
    struct iso_fault card_fault;    /* why the last card number was not sent */
    struct iso_door_look door_look; /* the door behind the last grant */
    char last_outcome[48 + ISO_PERSON_NAME_SIZE];
    char outcome_person[ISO_PERSON_NAME_SIZE]; /* whom last_outcome names; "" */
    struct iso_appliance_counts counts;
    struct iso_lockout lockout;
    struct iso_fault clock_fault;   /* the clock was set back; "": it was not */
    int64_t lockout_save_ns;        /* when to try again to keep it; ISO_NEVER_NS: it is kept */
    int64_t lockout_read_ns;        /* when to try again to read it; ISO_NEVER_NS: it is known */
    struct iso_fault lockout_fault; /* why it could not be read */
    struct iso_stale_budget stale_budget; /* the time that a grant needs */
    struct iso_fault stale_fault;         /* it comes near stale_ms; "": it does not */
    bool stale_told;                      /* a warning said so, since the sensor was opened */
    struct iso_fault storage_fault;       /* what the disk refused last; "" since it works again */
    struct iso_fault counter_fault;       /* of the counter of the state; "" while it works */
    bool counter_due;                     /* its number has to be raised ... */
    int64_t counter_due_ns;               /* ... since then ... */
    bool counter_noted;                   /* ... and a record was written for that */
    int64_t gallery_retry_ns; /* when to try again to read the gallery, while it is lost */

    /* CLAIMED, ENROLL, VERIFY, IDENTIFY */
    int64_t deadline_ns;                 /* of the claim, or of the action */
    enum iso_appliance_mode ended;       /* an action that ended by itself; CLAIMED: none */
    struct iso_person person;            /* ENROLL: who it will be; VERIFY: who it should be */
    struct iso_validity_change validity; /* ENROLL: the limits that were named */
    struct iso_enrolment enrolment;
    bool picture_due;       /* a client waits for the next frame */
    int64_t picture_end_ns; /* until then */
};

/* Tells of faults of the counter of the state directory, and sees that changes are counted.
 * (appliance_counter.c) */
void iso__appliance_counter_time(struct iso_appliance *appliance, int64_t now_ns);

/* A line for the system's log. */
__attribute__((format(printf, 3, 4))) void iso__appliance_say(struct iso_appliance *appliance,
                                                              int priority, const char *format,
                                                              ...);

/* Tells the system's log of an error, if it is one, and returns it. */
int iso__appliance_say_fault(struct iso_appliance *appliance, int error,
                             const struct iso_fault *fault);

/* Tells the system's log of a fault as a warning. */
void iso__appliance_warn(struct iso_appliance *appliance, const struct iso_fault *fault);

/* A warning, but only for the first of a row of frames that fail. */
void iso__appliance_complain(struct iso_appliance *appliance, const struct iso_fault *fault);

/* Writes a record and waits for the disk: for what must not happen without it. A failure is told to
 * the system's log, and returned. */
int iso__appliance_record(struct iso_appliance *appliance, const struct iso_audit_record *record);

/* The same of what is not done if this fails; the failure is told to the caller. */
int iso__appliance_record_first(struct iso_appliance *appliance,
                                const struct iso_audit_record *record, struct iso_fault *fault);

/* Writes a record of what has happened already, without waiting for the disk. A failure that is
 * known at once is returned; every failure is told to the system's log sooner or later. */
int iso__appliance_note(struct iso_appliance *appliance, const struct iso_audit_record *record);

/* Writes a record of what is to open the door, and waits for at most 250 ms. -ETIMEDOUT: it is not
 * on the disk by then, or was too late. Errors of the log are told to the system's log. */
int iso__appliance_record_grant(struct iso_appliance *appliance,
                                const struct iso_audit_record *record, struct iso_fault *fault);

/* Puts on record which gallery this is, and how often it was changed: `event` is "gallery" behind a
 * change, "start" before all. */
void iso__appliance_record_gallery(struct iso_appliance *appliance, const char *event,
                                   const char *note);

/* Remembers what became of a call that writes, if it is a matter of the disk: 0 or an error with
 * its fault. (appliance_storage.c) */
void iso__appliance_note_storage(struct iso_appliance *appliance, int error,
                                 const struct iso_fault *fault);

/* It is t_ns: tries to bring a gallery that is out of service back, once a second. */
void iso__appliance_storage_time(struct iso_appliance *appliance, int64_t t_ns);

/* What the disk refuses now or refused last; "" since it works again. */
const struct iso_fault *iso__appliance_storage_fault(const struct iso_appliance *appliance);

/* "started", "silent" (it runs, but nothing is seen), "repeats" (it delivers old frames again),
 * "lost". */
const char *iso__appliance_sensor_state(const struct iso_appliance *appliance);

/* ---- the door (appliance_door.c) ---- */

/* Before the first of the others. -ENOMEM, or an errno of the descriptors. */
int iso__appliance_new_door(struct iso_appliance *appliance);
void iso__appliance_free_door(struct iso_appliance *appliance);

/* Puts the door to work, unless it works already. -EAGAIN, -ENOMEM: no thread can be had. */
int iso__appliance_start_door(struct iso_appliance *appliance, struct iso_fault *fault);

/* Puts on record what the door has done since it was put to work, and from then on each change. */
void iso__appliance_record_door(struct iso_appliance *appliance);

/* Tells what the door has done, and what the log could not be told. Changes that chatter are folded
 * (door_events.h). */
void iso__appliance_tell_door(struct iso_appliance *appliance);

/* Puts on record, and tells, whatever was folded: before the end. */
void iso__appliance_flush_door(struct iso_appliance *appliance);

/* When iso__appliance_tell_door has to put folded changes on record, by the clock of the steps. */
int64_t iso__appliance_door_events_due_ns(struct iso_appliance *appliance);

void iso__appliance_refuse_at_door(struct iso_appliance *appliance);

/* Lets somebody in who was seen at since_ns, as the frames count: -ESTALE, and nothing else, if
 * that is longer ago than stale_ms, with the time that the machine was suspended. */
int iso__appliance_grant_at_door(struct iso_appliance *appliance, int64_t since_ns,
                                 enum iso_door_answer *answer);

/* ---- frames (appliance_frame.c) ---- */

/* A frame has come, or until t_ns none. */
void iso__appliance_frame(struct iso_appliance *appliance, const struct iso_frame *frame,
                          int64_t arrival_ns);
void iso__appliance_time(struct iso_appliance *appliance, int64_t t_ns);

/* Writes the attack attempt that goes on, if one does, into the log. */
void iso__appliance_end_attack(struct iso_appliance *appliance);

/* When one of deadlines, decisions, visits and attack attempts is due. */
int64_t iso__appliance_due_ns(const struct iso_appliance *appliance);

/* ---- frames that come again (appliance_repeat.c) ---- */

/* Whether the usable frame just extracted repeats one of the last ten minutes, and so is evidence
 * of nothing. Remembers it; a sensor that goes on repeating is told as a fault. */
bool iso__appliance_repeats(struct iso_appliance *appliance, const struct iso_frame *frame);

/* The sensor was opened anew: what it did before is no fault of now. The frames stay known. */
void iso__appliance_repeat_reset(struct iso_appliance *appliance);

/* ---- the time that a grant needs (appliance_stale.c) ---- */

/* The sensor was opened: takes its rate in, and warns if there is too little time. */
void iso__appliance_stale_sensor(struct iso_appliance *appliance);

/* The work on a usable frame has ended: takes in how long it took, and warns as above. */
void iso__appliance_stale_frame(struct iso_appliance *appliance, const struct iso_frame *frame);

/* ---- a clock that was set back (appliance_clock.c) ---- */

/* Whether the date is more than a minute before the latest one in the log. */
bool iso__appliance_clock_is_behind(const struct iso_appliance *appliance);

/* CLOCK_BEHIND, CLOCK_UNSET (the clock shows a date before this program was written), or
 * ISO_FAULT_NONE. */
enum iso_fault_code iso__appliance_clock_code(const struct iso_appliance *appliance);

/* The date by which limits are judged while the clock is not behind, seconds since 1970: it does
 * not go back by the minute that is tolerated. */
int64_t iso__appliance_date_s(const struct iso_appliance *appliance);

/* Tells and records that the clock is behind, or right again. */
void iso__appliance_clock_time(struct iso_appliance *appliance);

/* An administrator says that the clock is right and the log's date was not; on record. */
void iso__appliance_accept_clock(struct iso_appliance *appliance);

/* ---- people who were removed (appliance_forget.c) ---- */

/* Wipes what is left in memory of a person of this name, who is not in the gallery any more. */
void iso__appliance_forget(struct iso_appliance *appliance, const char *name);

/* ---- a picture (appliance_picture.c) ---- */

/* Hands a frame to who waits for it. */
void iso__appliance_picture_frame(struct iso_appliance *appliance, const struct iso_frame *frame);

/* Tells who waits that there will be no picture: at once, or if it has taken too long. */
void iso__appliance_picture_drop(struct iso_appliance *appliance);
void iso__appliance_picture_time(struct iso_appliance *appliance, int64_t now_ns);

/* ---- visits (appliance_visit.c, appliance_learn.c) ---- */

struct iso_decision_options iso__appliance_decision_options(const struct iso_config *config);

/* The score that is asked of a face now: it depends on how many people the face is compared with.
 */
double iso__appliance_threshold(const struct iso_appliance *appliance);

/* WATCH: the verdict of a visit. Logs it, tells the door, reports it. */
void iso__appliance_finish_visit(struct iso_appliance *appliance, struct iso_verdict verdict);

/* WATCH: keeps the template just extracted, if the visit that it ended is one to learn from. Last
 * of all: nobody waits for it. */
void iso__appliance_learn(struct iso_appliance *appliance, const struct iso_verdict *verdict);

/* Deletes what was learned, if nothing is to be learned any more; on record. */
void iso__appliance_unlearn(struct iso_appliance *appliance);

/* Whether a person may come in at this time; one who is not in the gallery may not. */
bool iso__appliance_is_valid(const struct iso_appliance *appliance, int64_t person);

/* How many of the enrolled people may come in at this time. */
size_t iso__appliance_count_valid(const struct iso_appliance *appliance);

/* ---- time ---- */

static inline int64_t iso__appliance_now_ns(const struct iso_appliance *appliance)
{
    return iso_times_now_ns(&appliance->borrowed.times);
}

/* ---- lock-out and lockdown (appliance_refusal.c) ---- */

/* Restores the lock-out of before the restart from its file. A file that is damaged, old or missing
 * causes a lockdown. If the disk cannot read the file, the appliance tries again every few seconds
 * and lets nobody in until then. */
void iso__appliance_start_lockout(struct iso_appliance *appliance);

/* Writes what has to outlast a restart. An errno of writing it; -EIO what is there could not be
 * read yet, and is not replaced. */
int iso__appliance_keep_lockout(struct iso_appliance *appliance, struct iso_fault *fault);

/* It is t_ns: a lock may be over, or the file may be read. */
void iso__appliance_lockout_time(struct iso_appliance *appliance, int64_t t_ns);

/* Whether nobody is let in, or recognised for a client: a lockdown, a lock-out, a lock-out file
 * that cannot be read yet, or a gallery that is out of service. */
bool iso__appliance_is_shut(const struct iso_appliance *appliance);

/* Has the verdict say nothing but that, if it is so. */
void iso__appliance_shut_out(const struct iso_appliance *appliance, struct iso_verdict *verdict);

/* Takes a verdict in that was told; a lock may begin. */
void iso__appliance_count_verdict(struct iso_appliance *appliance,
                                  const struct iso_verdict *verdict);

/* ---- actions of a client (appliance_action.c) ---- */

/* ENROLL: what stands against taking the template just extracted, or OK. */
enum iso_capture iso__appliance_enroll_gate(const struct iso_appliance *appliance);

/* ENROLL: takes the template just extracted, or a frame that has a cue of an attack. */
void iso__appliance_enroll_face(struct iso_appliance *appliance);
void iso__appliance_enroll_attack(struct iso_appliance *appliance, enum iso_capture cue);

/* VERIFY, IDENTIFY: the verdict. */
void iso__appliance_finish_recognition(struct iso_appliance *appliance,
                                       const struct iso_verdict *verdict);

/* WATCH, ENROLL, VERIFY, IDENTIFY: tells what hinders. */
void iso__appliance_tell_hint(struct iso_appliance *appliance, enum iso_capture capture);

/* Ends what has run out. */
void iso__appliance_action_deadline(struct iso_appliance *appliance, int64_t now_ns);

/* The sensor is gone. */
void iso__appliance_action_disconnect(struct iso_appliance *appliance);

#endif
