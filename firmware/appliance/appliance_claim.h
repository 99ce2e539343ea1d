/* The claim of a client, its actions, and enrolling. Internal to firmware/appliance. */
#ifndef ISO_FIRMWARE_APPLIANCE_APPLIANCE_CLAIM_H
#define ISO_FIRMWARE_APPLIANCE_APPLIANCE_CLAIM_H

#include "firmware/appliance/appliance_state.h"

/* ---- the claim and its actions (appliance_action.c) ---- */

void iso__appliance_init_claim(struct iso_appliance *appliance);

/* Whether an action may begin: -EACCES not claimed, -EBUSY an action goes on, -ENODEV no sensor, or
 * why the gallery is out of service. */
int iso__appliance_may_act(const struct iso_appliance *appliance, struct iso_fault *fault);

/* Begins an action, which ends after duration_ms at the latest. Visit, hints and a picture that is
 * awaited are dropped. */
void iso__appliance_begin_action(struct iso_appliance *appliance, enum iso_appliance_mode mode,
                                 int duration_ms);

/* Ends an action that has finished by itself. The report to the client comes before, because it
 * needs the mode. */
void iso__appliance_end_action(struct iso_appliance *appliance);

/* VERIFY, IDENTIFY: handles the verdict. */
void iso__appliance_finish_recognition(struct iso_appliance *appliance,
                                       const struct iso_verdict *verdict);

/* WATCH, ENROLL, VERIFY, IDENTIFY: gives a hint to the person. */
void iso__appliance_tell_hint(struct iso_appliance *appliance, enum iso_capture capture);

/* Ends the claim or the action if its time is over. */
void iso__appliance_action_deadline(struct iso_appliance *appliance, int64_t now_ns);
int64_t iso__appliance_action_due_ns(const struct iso_appliance *appliance);

/* Ends an action because the sensor is lost. The claim stays. */
void iso__appliance_action_disconnect(struct iso_appliance *appliance);

/* Wipes the person of the last action. */
void iso__appliance_forget_claim(struct iso_appliance *appliance);

/* ---- enrolling (appliance_enroll.c) ---- */

/* Returns ISO_CAPTURE_OK if an enrolment can use the template of the last frame, else the reason
 * why it cannot. */
enum iso_capture iso__appliance_enroll_gate(const struct iso_appliance *appliance);

/* Adds the template of the last frame to the enrolment. */
void iso__appliance_enroll_face(struct iso_appliance *appliance);

/* Counts a frame that has a cue of an attack; `cue` is the cue. */
void iso__appliance_enroll_attack(struct iso_appliance *appliance, enum iso_capture cue);

/* Sends a hint to the client that enrols; `word` is a result of firmware/contract/contract.h. */
void iso__appliance_tell_enrolment_hint(struct iso_appliance *appliance, const char *word);

/* Ends the enrolment because the sensor is lost. */
void iso__appliance_disconnect_enrolment(struct iso_appliance *appliance);

/* Ends the enrolment, or its step, if its time is over at now_ns. */
void iso__appliance_time_enrolment(struct iso_appliance *appliance, int64_t now_ns);
int64_t iso__appliance_enrolment_due_ns(const struct iso_appliance *appliance);

/* Wipes the templates of the enrolment. */
void iso__appliance_wipe_enrolment(struct iso_appliance *appliance);

/* Wipes the templates and the person of the enrolment. */
void iso__appliance_forget_enrolment(struct iso_appliance *appliance);

#endif
