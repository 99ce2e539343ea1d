/* What the files of firmware/appliance call of each other. Internal to firmware/appliance. */
#ifndef ISO_FIRMWARE_APPLIANCE_APPLIANCE_CALLS_H
#define ISO_FIRMWARE_APPLIANCE_APPLIANCE_CALLS_H

#include "firmware/appliance/appliance_state.h"
#include "firmware/contract/fault_tag.h"

static inline int64_t iso__appliance_now_ns(const struct iso_appliance *appliance)
{
    return iso_times_now_ns(&appliance->borrowed.times);
}

/* ---- records and the system's log (appliance_log.c) ---- */

/* A line for the system's log. */
__attribute__((format(printf, 3, 4))) void iso__appliance_say(struct iso_appliance *appliance,
                                                              int priority, const char *format,
                                                              ...);

/* Tells the system's log of an error, if it is one, and returns it. */
int iso__appliance_say_fault(struct iso_appliance *appliance, int error,
                             const struct iso_fault *fault);

/* Tells the system's log of a fault as a warning. */
void iso__appliance_warn(struct iso_appliance *appliance, const struct iso_fault *fault);

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

/* ---- disk and counter (appliance_storage.c) ---- */

void iso__appliance_init_storage(struct iso_appliance *appliance);

/* Remembers what became of a call that writes, if it is a matter of the disk: 0 or an error with
 * its fault. */
void iso__appliance_note_storage(struct iso_appliance *appliance, int error,
                                 const struct iso_fault *fault);

/* Tells what became of posted records, if the writer of the log knows it. */
void iso__appliance_tell_log(struct iso_appliance *appliance);

/* It is t_ns: tries to bring a gallery that is out of service back, once a second. */
void iso__appliance_storage_time(struct iso_appliance *appliance, int64_t t_ns);
int64_t iso__appliance_storage_due_ns(const struct iso_appliance *appliance);

/* What the disk refuses now or refused last; "" since it works again. */
const struct iso_fault *iso__appliance_storage_fault(const struct iso_appliance *appliance);

/* Tells of faults of the counter of the state directory, and sees that changes are counted. */
void iso__appliance_counter_time(struct iso_appliance *appliance, int64_t now_ns);

/* ---- the sensor (appliance_sensor.c) ---- */

/* The first try to open the sensor. -EINVAL, -ENOENT: its configuration can never work; any other
 * failure is told, and the sensor is tried again. */
int iso__appliance_open_sensor(struct iso_appliance *appliance, int64_t now_ns,
                               struct iso_fault *fault);
void iso__appliance_close_sensor(struct iso_appliance *appliance);

/* Takes in what the sensor has: a frame, its loss, its return. */
void iso__appliance_look_at_sensor(struct iso_appliance *appliance, int64_t now_ns);
int64_t iso__appliance_sensor_due_ns(const struct iso_appliance *appliance, int64_t now_ns);

/* -ENODEV: there is none now, and why. */
int iso__appliance_has_sensor(const struct iso_appliance *appliance, struct iso_fault *fault);

/* A fault of the sensor that its frames show: kept for the status, and told. */
void iso__appliance_blame_sensor(struct iso_appliance *appliance, const struct iso_fault *fault);

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

/* ---- the face in a frame (appliance_face.c) ---- */

void iso__appliance_init_face(struct iso_appliance *appliance);

/* Whoever was before the camera may be another by now: the visit and the track begin anew. */
void iso__appliance_forget_face(struct iso_appliance *appliance);

/* A warning, but only for the first of a row of frames that fail; the row ends by the second. */
void iso__appliance_complain(struct iso_appliance *appliance, const struct iso_fault *fault);
void iso__appliance_end_complaints(struct iso_appliance *appliance);

/* Whether a frame comes so late that it says nothing about who is there now. For a frame that was
 * exposed before the machine was suspended nobody knows how late it is. */
bool iso__appliance_is_stale(struct iso_appliance *appliance, const struct iso_frame *frame,
                             int64_t arrival_ns);

/* Extracts the template. An error of the pipeline, which was told. */
int iso__appliance_extract(struct iso_appliance *appliance, const struct iso_frame *frame);
void iso__appliance_wipe_template(struct iso_appliance *appliance);

/* What becomes of the frame just extracted: the extraction's own word, or what speaks against using
 * a good one. */
enum iso_capture iso__appliance_judge(struct iso_appliance *appliance,
                                      const struct iso_frame *frame);

/* Whether the frame just judged may count as evidence. Every usable one is remembered, whatever
 * else speaks against it: it may come again. */
bool iso__appliance_is_evidence(struct iso_appliance *appliance, const struct iso_frame *frame);

/* What people are told of a frame. Something within reach that is not a face and does not move is
 * furniture: nobody is there. The decision does not depend on this. */
enum iso_capture iso__appliance_tell_of(struct iso_appliance *appliance,
                                        const struct iso_frame *frame, enum iso_capture capture);

/* ---- frames (appliance_frame.c) ---- */

void iso__appliance_init_visit(struct iso_appliance *appliance);

/* Forgets the frames of the visit or action: it is decided from the next frame on. */
void iso__appliance_decide_anew(struct iso_appliance *appliance);

/* The hints begin anew; or the last one may be given again at once (hint_filter.h). */
void iso__appliance_reset_hints(struct iso_appliance *appliance);
void iso__appliance_forget_hint(struct iso_appliance *appliance);

/* A frame has come, or until t_ns none. */
void iso__appliance_frame(struct iso_appliance *appliance, const struct iso_frame *frame,
                          int64_t arrival_ns);
void iso__appliance_time(struct iso_appliance *appliance, int64_t t_ns);

/* Writes the attack attempt that goes on, if one does, into the log. */
void iso__appliance_end_attack(struct iso_appliance *appliance);

/* When a decision or an attack attempt is due. */
int64_t iso__appliance_visit_due_ns(const struct iso_appliance *appliance);

/* Keeps what was seen for the status, and tells it while the sensor is aimed.
 * (appliance_status.c) */
void iso__appliance_show(struct iso_appliance *appliance, enum iso_capture capture);

/* ---- frames that come again (appliance_repeat.c) ---- */

int iso__appliance_new_repeats(struct iso_appliance *appliance); /* -ENOMEM */
void iso__appliance_free_repeats(struct iso_appliance *appliance);

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

/* ---- a picture (appliance_picture.c) ---- */

/* Hands a frame to who waits for it. */
void iso__appliance_picture_frame(struct iso_appliance *appliance, const struct iso_frame *frame);

/* Tells who waits that there will be no picture: at once, or if it has taken too long. */
void iso__appliance_picture_drop(struct iso_appliance *appliance);
void iso__appliance_picture_time(struct iso_appliance *appliance, int64_t now_ns);
int64_t iso__appliance_picture_due_ns(const struct iso_appliance *appliance);

/* ---- visits (appliance_visit.c, appliance_learn.c) ---- */

struct iso_decision_options iso__appliance_decision_options(const struct iso_config *config);

/* The score that is asked of a face now: it depends on how many people the face is compared with.
 */
double iso__appliance_threshold(const struct iso_appliance *appliance);

/* WATCH: the verdict of a visit. Logs it, tells the door, reports it. */
void iso__appliance_finish_visit(struct iso_appliance *appliance, struct iso_verdict verdict);

/* One more frame has a cue of an attack. */
void iso__appliance_count_attack_frame(struct iso_appliance *appliance);

/* Wipes the name of a person who was removed from the text of the last visit. */
void iso__appliance_forget_outcome(struct iso_appliance *appliance, const char *name);

/* WATCH: keeps the template just extracted, if the visit that it ended is one to learn from. Last
 * of all: nobody waits for it. */
void iso__appliance_learn(struct iso_appliance *appliance, const struct iso_verdict *verdict);

/* Deletes what was learned, if nothing is to be learned any more; on record. */
void iso__appliance_unlearn(struct iso_appliance *appliance);

/* Whether a person may come in at this time; one who is not in the gallery may not. */
bool iso__appliance_is_valid(const struct iso_appliance *appliance, int64_t person);

/* How many of the enrolled people may come in at this time. */
size_t iso__appliance_count_valid(const struct iso_appliance *appliance);

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

int64_t iso__appliance_lockout_due_ns(const struct iso_appliance *appliance);

/* What the file says is not known, and the disk may let it be read later. */
bool iso__appliance_lockout_is_unread(const struct iso_appliance *appliance);

/* The lockdown or the lock-out, or ISO_REASON_NONE. */
enum iso_reason iso__appliance_lock_reason(const struct iso_appliance *appliance);

/* Whether nobody is let in, or recognised for a client: a lockdown, a lock-out, a lock-out file
 * that cannot be read yet, or a gallery that is out of service. */
bool iso__appliance_is_shut(const struct iso_appliance *appliance);

/* Has the verdict say nothing but that, if it is so. */
void iso__appliance_shut_out(const struct iso_appliance *appliance, struct iso_verdict *verdict);

/* Takes a verdict in that was told; a lock may begin. */
void iso__appliance_count_verdict(struct iso_appliance *appliance,
                                  const struct iso_verdict *verdict);

/* ---- the claim and its actions (appliance_action.c) ---- */

void iso__appliance_init_claim(struct iso_appliance *appliance);

/* Whether an action may begin: -EACCES not claimed, -EBUSY an action goes on, -ENODEV no sensor, or
 * why the gallery is out of service. */
int iso__appliance_may_act(const struct iso_appliance *appliance, struct iso_fault *fault);

void iso__appliance_begin_action(struct iso_appliance *appliance, enum iso_appliance_mode mode,
                                 int duration_ms);

/* The action has ended by itself. Clients are told before, because that needs the mode. */
void iso__appliance_end_action(struct iso_appliance *appliance);

/* VERIFY, IDENTIFY: the verdict. */
void iso__appliance_finish_recognition(struct iso_appliance *appliance,
                                       const struct iso_verdict *verdict);

/* WATCH, ENROLL, VERIFY, IDENTIFY: tells what hinders. */
void iso__appliance_tell_hint(struct iso_appliance *appliance, enum iso_capture capture);

/* Ends what has run out. */
void iso__appliance_action_deadline(struct iso_appliance *appliance, int64_t now_ns);
int64_t iso__appliance_action_due_ns(const struct iso_appliance *appliance);

/* The sensor is gone. */
void iso__appliance_action_disconnect(struct iso_appliance *appliance);

/* Wipes the person of the last action. */
void iso__appliance_forget_claim(struct iso_appliance *appliance);

/* ---- enrolling (appliance_enroll.c) ---- */

/* What stands against taking the template just extracted, or OK. */
enum iso_capture iso__appliance_enroll_gate(const struct iso_appliance *appliance);

/* Takes the template just extracted, or a frame that has a cue of an attack. */
void iso__appliance_enroll_face(struct iso_appliance *appliance);
void iso__appliance_enroll_attack(struct iso_appliance *appliance, enum iso_capture cue);

/* Tells what hinders: a result of firmware/contract/contract.h. */
void iso__appliance_tell_enrolment_hint(struct iso_appliance *appliance, const char *word);

/* The sensor is gone; or it is now_ns, and the time may be up. */
void iso__appliance_disconnect_enrolment(struct iso_appliance *appliance);
void iso__appliance_time_enrolment(struct iso_appliance *appliance, int64_t now_ns);

/* Wipes the templates; or the person and the limits as well. */
void iso__appliance_wipe_enrolment(struct iso_appliance *appliance);
void iso__appliance_forget_enrolment(struct iso_appliance *appliance);

#endif
