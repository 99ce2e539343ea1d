/* Functions that the files of firmware/appliance call in each other. Internal to
 * firmware/appliance. */
#ifndef ISO_FIRMWARE_APPLIANCE_APPLIANCE_CALLS_H
#define ISO_FIRMWARE_APPLIANCE_APPLIANCE_CALLS_H

#include "firmware/appliance/appliance_state.h"
#include "firmware/contract/fault_tag.h"

static inline int64_t iso__appliance_now_ns(const struct iso_appliance *appliance)
{
    return iso_times_now_ns(&appliance->borrowed.times);
}

/* ---- records and the system's log (appliance_log.c) ---- */

/* Writes a line to the system's log. */
__attribute__((format(printf, 3, 4))) void iso__appliance_say(struct iso_appliance *appliance,
                                                              int priority, const char *format,
                                                              ...);

/* If `error` is an error, writes it to the system's log. Returns it. */
int iso__appliance_say_fault(struct iso_appliance *appliance, int error,
                             const struct iso_fault *fault);

/* Writes a fault to the system's log as a warning. */
void iso__appliance_warn(struct iso_appliance *appliance, const struct iso_fault *fault);

/* Writes a record and waits until it is on the disk. A failure is written to the system's log, and
 * returned. */
int iso__appliance_record(struct iso_appliance *appliance, const struct iso_audit_record *record);

/* The same for an act that must not be done if this fails. The failure goes to the caller, and not
 * to the system's log. */
int iso__appliance_record_first(struct iso_appliance *appliance,
                                const struct iso_audit_record *record, struct iso_fault *fault);

/* Writes a record of something that has happened already, without waiting for the disk. A failure
 * that is known at once is returned. Every failure is written to the system's log sooner or
 * later. */
int iso__appliance_note(struct iso_appliance *appliance, const struct iso_audit_record *record);

/* Writes the record of a grant before the door opens, and waits for at most 250 ms. -ETIMEDOUT: it
 * is not on the disk by then, or was too late. Errors of the log are written to the system's
 * log. */
int iso__appliance_record_grant(struct iso_appliance *appliance,
                                const struct iso_audit_record *record, struct iso_fault *fault);

/* Records which gallery this is, and how often it was changed. `event` is "gallery" after a change,
 * and "start" at the start. */
void iso__appliance_record_gallery(struct iso_appliance *appliance, const char *event,
                                   const char *note);

/* ---- settings (appliance_settings.c) ---- */

/* Reads the settings that were changed before the restart. Called before the lock-out and the
 * sensor are started. */
void iso__appliance_load_settings(struct iso_appliance *appliance);

/* Lets all parts use the present settings. A visit that has begun is forgotten. */
void iso__appliance_apply_settings(struct iso_appliance *appliance);

/* ---- disk and counter (appliance_storage.c) ---- */

void iso__appliance_init_storage(struct iso_appliance *appliance);

/* Notes the result of a call that writes, if it depends on the disk: 0, or an error with its
 * fault. */
void iso__appliance_note_storage(struct iso_appliance *appliance, int error,
                                 const struct iso_fault *fault);

/* Reports the results of posted records, as far as the writer of the log knows them. */
void iso__appliance_tell_log(struct iso_appliance *appliance);

/* Does what is due at t_ns: tries once a second to bring a gallery that is out of service back. */
void iso__appliance_storage_time(struct iso_appliance *appliance, int64_t t_ns);
int64_t iso__appliance_storage_due_ns(const struct iso_appliance *appliance);

/* The present or last error of the disk; "" once it works again. */
const struct iso_fault *iso__appliance_storage_fault(const struct iso_appliance *appliance);

/* Reports faults of the counter of the state directory, and makes sure that changes are counted. */
void iso__appliance_counter_time(struct iso_appliance *appliance, int64_t now_ns);

/* ---- the sensor (appliance_sensor.c) ---- */

/* Tries to open the sensor for the first time. -EINVAL, -ENOENT: its configuration can never work.
 * Any other failure is reported, and the sensor is tried again. */
int iso__appliance_open_sensor(struct iso_appliance *appliance, int64_t now_ns,
                               struct iso_fault *fault);
void iso__appliance_close_sensor(struct iso_appliance *appliance);

/* Handles the news of the sensor: a frame, its loss, its return. */
void iso__appliance_look_at_sensor(struct iso_appliance *appliance, int64_t now_ns);
int64_t iso__appliance_sensor_due_ns(const struct iso_appliance *appliance, int64_t now_ns);

/* Returns 0, or -ENODEV with the reason if there is no sensor now. */
int iso__appliance_has_sensor(const struct iso_appliance *appliance, struct iso_fault *fault);

/* A fault of the sensor that its frames show. It is kept for the status, and reported. */
void iso__appliance_blame_sensor(struct iso_appliance *appliance, const struct iso_fault *fault);

/* "started", "silent" (it runs, but nothing is seen), "repeats" (it delivers old frames again),
 * "lost". */
const char *iso__appliance_sensor_state(const struct iso_appliance *appliance);

/* ---- the door (appliance_door.c) ---- */

/* Called before the other functions of the door. -ENOMEM, or an errno of the descriptors. */
int iso__appliance_new_door(struct iso_appliance *appliance);
void iso__appliance_free_door(struct iso_appliance *appliance);

/* Starts the door, unless it has started already, and warns if its thread has no real-time
 * priority. -EAGAIN, -ENOMEM: no thread can be had. */
int iso__appliance_start_door(struct iso_appliance *appliance, struct iso_fault *fault);

/* Records what the door has done since it was started, and from then on each change. */
void iso__appliance_record_door(struct iso_appliance *appliance);

/* Reports changes of the door, how many of them were missed, and the results of posted records.
 * Changes of an input that chatters are only counted (door_events.h). */
void iso__appliance_tell_door(struct iso_appliance *appliance);

/* Records and reports all changes that were only counted. Called before the end. */
void iso__appliance_flush_door(struct iso_appliance *appliance);

/* When iso__appliance_tell_door has to record counted changes, by the clock of the steps. */
int64_t iso__appliance_door_events_due_ns(struct iso_appliance *appliance);

/* Says why the line or the stored key of the panel could not be used. Records
 * and reports changes of the panel, and when this is due next. They do nothing without a panel. */
void iso__appliance_start_panel(struct iso_appliance *appliance);
void iso__appliance_tell_panel(struct iso_appliance *appliance, int64_t now_ns);
int64_t iso__appliance_panel_due_ns(const struct iso_appliance *appliance);

/* Shows a refusal at the door. */
void iso__appliance_refuse_at_door(struct iso_appliance *appliance);

/* Lets a person in who was seen at since_ns, by the clock of the frames. *answer says what the door
 * did. -ESTALE, without any effect, if that is longer ago than stale_ms; the time for which the
 * machine was suspended counts, too. */
int iso__appliance_grant_at_door(struct iso_appliance *appliance, int64_t since_ns,
                                 enum iso_door_answer *answer);

/* ---- the face in a frame (appliance_face.c) ---- */

void iso__appliance_init_face(struct iso_appliance *appliance);

/* Another person may be before the camera now: begins the visit and the track again. */
void iso__appliance_forget_face(struct iso_appliance *appliance);

/* Writes a warning for the first of several frames that fail one after the other, and none for the
 * others. */
void iso__appliance_complain(struct iso_appliance *appliance, const struct iso_fault *fault);
void iso__appliance_end_complaints(struct iso_appliance *appliance);

/* Whether a frame is so late that it does not show who is there now. The delay of a frame that was
 * exposed before the machine was suspended is not known, so it counts as late. */
bool iso__appliance_is_stale(struct iso_appliance *appliance, const struct iso_frame *frame,
                             int64_t arrival_ns);

/* Extracts the template. Returns an error of the pipeline, which was reported already. */
int iso__appliance_extract(struct iso_appliance *appliance, const struct iso_frame *frame);
void iso__appliance_wipe_template(struct iso_appliance *appliance);

/* The word for the frame just extracted: the word of the extraction, or the reason why a good
 * template cannot be used. */
enum iso_capture iso__appliance_judge(struct iso_appliance *appliance,
                                      const struct iso_frame *frame);

/* Whether the frame just judged may count as evidence. Every usable frame is remembered, even if
 * something else speaks against it, because it may come again. */
bool iso__appliance_is_evidence(struct iso_appliance *appliance, const struct iso_frame *frame);

/* Compares a frame with those before it: whether it needs no examination (sensor/rest.h). */
bool iso__appliance_rests(struct iso_appliance *appliance, const struct iso_frame *frame);
void iso__appliance_end_rest(struct iso_appliance *appliance);

/* The word that people are told for a frame. Something within reach that is not a face and does not
 * move is furniture, so nobody is there. The decision does not depend on this; the rest does. */
enum iso_capture iso__appliance_tell_of(struct iso_appliance *appliance,
                                        const struct iso_frame *frame, enum iso_capture capture);

/* ---- frames (appliance_frame.c) ---- */

void iso__appliance_init_visit(struct iso_appliance *appliance);

/* Forgets the frames of the visit or action. The decision begins with the next frame. */
void iso__appliance_decide_anew(struct iso_appliance *appliance);

/* Resets the hints, or allows the last hint to be repeated at once (hint_filter.h). */
void iso__appliance_reset_hints(struct iso_appliance *appliance);
void iso__appliance_forget_hint(struct iso_appliance *appliance);

/* Handles a frame that arrived at arrival_ns; or the time t_ns, until which no other frame has
 * come. */
void iso__appliance_frame(struct iso_appliance *appliance, const struct iso_frame *frame,
                          int64_t arrival_ns);
void iso__appliance_time(struct iso_appliance *appliance, int64_t t_ns);

/* Ends an attack attempt, if there is one, and writes it into the log. */
void iso__appliance_end_attack(struct iso_appliance *appliance);

/* The time at which a decision or an attack attempt is due. */
int64_t iso__appliance_visit_due_ns(const struct iso_appliance *appliance);

/* Keeps the view of a frame for the status, and reports it while the sensor is aimed.
 * (appliance_status.c) */
void iso__appliance_show(struct iso_appliance *appliance, enum iso_capture capture);

/* ---- frames that come again (appliance_repeat.c) ---- */

int iso__appliance_new_repeats(struct iso_appliance *appliance); /* -ENOMEM */
void iso__appliance_free_repeats(struct iso_appliance *appliance);

/* Whether the usable frame just extracted repeats one of the last ten minutes, and therefore is no
 * evidence. Remembers the frame. A sensor that keeps repeating frames is reported as a fault. A
 * replay whose frames may count more than once never repeats. */
bool iso__appliance_repeats(struct iso_appliance *appliance, const struct iso_frame *frame);

/* The sensor was opened again, so its earlier repetitions are no longer a fault. The frames are
 * still remembered. */
void iso__appliance_repeat_reset(struct iso_appliance *appliance);

/* ---- the time that a grant needs (appliance_stale.c) ---- */

/* Called when the sensor was opened: uses its rate, and warns if grants have too little time. */
void iso__appliance_stale_sensor(struct iso_appliance *appliance);

/* [decision] agree has changed. */
void iso__appliance_stale_agree(struct iso_appliance *appliance);

/* Called when a usable frame was extracted and judged: uses the time since its exposure, and warns
 * as above. The comparison with the gallery comes later and does not count. */
void iso__appliance_stale_frame(struct iso_appliance *appliance, const struct iso_frame *frame);

/* ---- a clock that was set back (appliance_clock.c) ---- */

/* Whether the date is more than a minute before the latest one in the log. */
bool iso__appliance_clock_is_behind(const struct iso_appliance *appliance);

/* CLOCK_BEHIND, CLOCK_UNSET (the clock shows a date before this program was written), or
 * ISO_FAULT_NONE. */
enum iso_fault_code iso__appliance_clock_code(const struct iso_appliance *appliance);

/* The date by which limits are judged while the clock is not behind, in seconds since 1970: that of
 * the clock, or the latest one in the log if that is later. */
int64_t iso__appliance_date_s(const struct iso_appliance *appliance);

/* Reports and records that the clock is behind, or right again. */
void iso__appliance_clock_time(struct iso_appliance *appliance);

/* Accepts the date of a clock that is behind, because an administrator says so. This is recorded.
 */
void iso__appliance_accept_clock(struct iso_appliance *appliance);

/* ---- a picture (appliance_picture.c) ---- */

/* Hands a frame to the client that waits for it. */
void iso__appliance_picture_frame(struct iso_appliance *appliance, const struct iso_frame *frame);

/* Reports a frame to those who watch, with its final word. Does nothing if nobody does. */
void iso__appliance_report_frame(struct iso_appliance *appliance, const struct iso_frame *frame,
                                 enum iso_capture capture);

/* Tells the waiting client that no picture comes: at once, or after too long a wait. */
void iso__appliance_picture_drop(struct iso_appliance *appliance);
void iso__appliance_picture_time(struct iso_appliance *appliance, int64_t now_ns);
int64_t iso__appliance_picture_due_ns(const struct iso_appliance *appliance);

/* ---- acts of an administrator (administration/administration.c) ---- */

/* Returns 0, or -EBUSY while an action of a client goes on. */
int iso__appliance_may_begin(const struct iso_appliance *appliance, struct iso_fault *fault);

/* Records a change of one person, or of the policy, before it is made; and its result after it, if
 * it could not be made. Names go only into the sealed log. (administration/administration.c) */
int iso__appliance_record_change(struct iso_appliance *appliance,
                                 const struct iso_audit_record *record, struct iso_fault *fault);
void iso__appliance_conclude_change(struct iso_appliance *appliance,
                                    struct iso_audit_record *record, int error,
                                    const struct iso_fault *fault);

/* ---- the fleet (administration/fleet.c) ---- */

/* Reads what is stored of the fleet, and asks it at each decision. If the gallery cannot be read,
 * this is tried again, and nobody is admitted meanwhile. */
void iso__appliance_start_fleet(struct iso_appliance *appliance);
void iso__appliance_free_fleet(struct iso_appliance *appliance);

/* Records the end of a lease, and reports what waits for the link. */
void iso__appliance_fleet_time(struct iso_appliance *appliance, int64_t now_ns);
int64_t iso__appliance_fleet_due_ns(const struct iso_appliance *appliance);

/* Returns 0 if an administrator of this door may change this person, else -EINVAL: "ada is managed
 * by the hub HQ". NULL: a new person. */
int iso__appliance_may_change(const struct iso_appliance *appliance,
                              const struct iso_person *person, struct iso_fault *fault);

/* Returns 0 if an import may go on: it replaces nobody who came from the fleet. */
int iso__appliance_may_replace(const struct iso_appliance *appliance,
                               const struct iso_gallery_item *items, size_t n, bool replace,
                               struct iso_fault *fault);

/* Returns 0 if the fleet admits this person now, else -EPERM with the reason. */
int iso__appliance_fleet_admits(const struct iso_appliance *appliance, int64_t person,
                                struct iso_fault *fault);

/* Why there is no lease, "" if there is one: for the record of a refusal. */
enum { ISO__APPLIANCE_WHY_SIZE = 96 };
void iso__appliance_why_no_lease(const struct iso_appliance *appliance,
                                 char text[ISO__APPLIANCE_WHY_SIZE]);

/* Wipes the data in memory of a person of this name, who is not in the gallery any more.
 * (administration/remove.c) */
void iso__appliance_forget_person(struct iso_appliance *appliance, const char *name);

/* Stores a policy that comes from the hub, as iso_appliance_set_policy() does.
 * (administration/policy.c) */
int iso__appliance_take_policy(struct iso_appliance *appliance, const char *json, const char *who,
                               struct iso_fault *fault);

/* ---- visits (appliance_visit.c, verdict/verdict_finish.c, appliance_learn.c) ---- */

/* The options of the decision for this configuration. */
struct iso_decision_options iso__appliance_decision_options(const struct iso_config *config);

/* The score that a face needs now. It depends on how many people the face is compared with. */
double iso__appliance_threshold(const struct iso_appliance *appliance);

/* WATCH: handles the verdict of a visit. Asks the policy, records the verdict, switches the door,
 * reports it, and may learn from it. Returns false if the policy wants more, so that this is no
 * verdict yet; otherwise *verdict is that of the policy. */
bool iso__appliance_finish_visit(struct iso_appliance *appliance, struct iso_verdict *verdict);

/* WATCH: the same for a verdict that a card, a PIN or the time has brought. The policy has been
 * asked. */
void iso__appliance_finish_factor(struct iso_appliance *appliance, struct iso_verdict *verdict);

/* The same for a verdict that does not count for the lock-out. */
void iso__appliance_finish_strange(struct iso_appliance *appliance, struct iso_verdict *verdict);

/* Counts a frame with a cue of an attack. */
void iso__appliance_count_attack_frame(struct iso_appliance *appliance);

/* Wipes the name of a person who was removed from the text of the last visit. */
void iso__appliance_forget_outcome(struct iso_appliance *appliance, const char *name);

/* WATCH: stores the template just extracted, if the visit that it ended is one to learn from. This
 * is the last step of a visit, so that nobody waits for it. */
void iso__appliance_learn(struct iso_appliance *appliance, const struct iso_verdict *verdict);

/* Deletes the learned templates if the configuration learns none any more, and records it. */
void iso__appliance_unlearn(struct iso_appliance *appliance);

/* Takes a metric into use that was adapted to the people, and records it. */
void iso__appliance_follow_site(struct iso_appliance *appliance);

/* Whether a person may come in at this time. A person who is not in the gallery may not. */
bool iso__appliance_is_valid(const struct iso_appliance *appliance, int64_t person);

/* How many of the enrolled people may come in at this time. */
size_t iso__appliance_count_valid(const struct iso_appliance *appliance);

/* ---- lock-out and lockdown (appliance_refusal.c) ---- */

/* Restores the lock-out of before the restart from its file. A file that is damaged, old or missing
 * causes a lockdown. If the disk cannot read the file, the appliance tries again every few seconds
 * and lets nobody in until then. */
void iso__appliance_start_lockout(struct iso_appliance *appliance);

/* The settings of the lock-out have changed. What was counted stays. */
void iso__appliance_configure_lockout(struct iso_appliance *appliance);

/* Writes the state that has to outlast a restart. Returns an errno of writing it, or -EIO if the
 * existing file could not be read yet and is therefore not replaced. */
int iso__appliance_keep_lockout(struct iso_appliance *appliance, struct iso_fault *fault);

/* Does what is due at t_ns: ends a lock, reads the file, or writes it. */
void iso__appliance_lockout_time(struct iso_appliance *appliance, int64_t t_ns);

int64_t iso__appliance_lockout_due_ns(const struct iso_appliance *appliance);

/* Whether the file could not be read yet, but may be readable later. */
bool iso__appliance_lockout_is_unread(const struct iso_appliance *appliance);

/* Returns the reason of the lockdown or the lock-out, or ISO_REASON_NONE. */
enum iso_reason iso__appliance_lock_reason(const struct iso_appliance *appliance);

/* Whether nobody is let in, or recognised for a client: a lockdown, a lock-out, a lock-out file
 * that cannot be read yet, or a gallery that is out of service. */
bool iso__appliance_is_shut(const struct iso_appliance *appliance);

/* Replaces the verdict by a refusal with the reason, if nobody is let in. */
void iso__appliance_shut_out(const struct iso_appliance *appliance, struct iso_verdict *verdict);

/* Counts a verdict that was reported. A lock may begin. */
void iso__appliance_count_verdict(struct iso_appliance *appliance,
                                  const struct iso_verdict *verdict);

#endif
