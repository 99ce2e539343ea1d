/* The contract between the daemon and its clients: the D-Bus service of isothermd, modelled on
 * fprintd. */
/* clang-format off */
/* Methods (signature in -> out). Those marked + need the claim, all others do not.
 *
 *   Claim()                              takes the camera; the door is not watched meanwhile
 * + Release()                            gives it back; leaving the bus gives it back, too
 * + EnrollStart(s person, a{sv}) -> a{sv}
 *                                        options ISO_CONTRACT_CONSENT b: the person has consented,
 *                                        which is recorded first, as the act "consent" with the
 *                                        caller's user; ..._ALLOW_DUPLICATE b, ..._VALID_FROM x,
 *                                        ..._VALID_UNTIL x (seconds since 1970; 0: no limit),
 *                                        ..._EXPIRED b, ..._POSES b: after the frontal face also
 *                                        the other poses, each as a template of its own; without
 *                                        it the frontal face alone. A limit that is not named stays
 *                                        as it is stored. An end in the past is refused without
 *                                        EXPIRED. If the name is in use, the reply describes the
 *                                        person, else it is empty: "person" s (as it is spelt),
 *                                        "enrolled" x, "templates" u, "valid-from" x, "valid-until" x
 * + EnrollStop()
 * + VerifyStart(s person)  VerifyStop()  IdentifyStart()  IdentifyStop()
 *   VerifySelf() -> u user               verifies the person of the calling Unix user for a login of
 *                                        this machine. The daemon asks the bus for the user and looks
 *                                        the person up (login_users.h). It is for everybody. The
 *                                        caller has the camera until the last VerifyStatus, in which
 *                                        person is "", score NaN and threshold 0. It may call nothing
 *                                        that needs the claim, and ends the login by leaving the bus.
 *                                        The same user may call again two seconds later. The reply is
 *                                        the user
 *   VerifyLogin(s person)                the same for root, who says which person it is.
 *                                        Both are recorded first, as the act "login" with the user,
 *                                        and refused with NoLogins unless [login] desk is set
 *   ListPeople() -> a(sxxxu)             person, enrolled, valid_from, valid_until (s), templates
 *   DeletePerson(s person)
 *   SetValidity(s person, a{sv}) -> s person, x valid_from, x valid_until
 *                                        options VALID_FROM, VALID_UNTIL, EXPIRED as above; the
 *                                        reply contains the limits that are stored now
 *   RenamePerson(s person, s name) -> s remark
 *                                        gives a person another name; a remark for people, or ""
 *   GetStatus() -> a{sv}                 the keys of status_keys.h
 *   GetSettings() -> a(ssssssbs)         for administrators: each key of the configuration, with the
 *                                        options of the chosen sensor and door: section, key, value in
 *                                        force, default, allowed values, help (firmware/config/settings.h);
 *                                        whether SetSetting changes it, and the value of the configuration
 *                                        file, which is that in force unless SetSetting has changed it
 *   SetSetting(s section, s key, s value) -> s value
 *                                        for administrators: changes a setting at once and over restarts,
 *                                        on record with the values before and after. The value is checked
 *                                        as a line of the configuration file is. The reply is the value in
 *                                        force. It is refused while an action of a client goes on
 *   ResetSetting(s section, s key) -> s value
 *                                        the same; the configuration file's value holds again
 *   GetSite() -> a{sv}                   what the people have taught the metric, and the error rates
 *                                        that their templates show: the keys of status_keys.h
 *   ListLookAlikes() -> a(ssd)           pairs of people who look alike, for clients that may call
 *                                        ListPeople: two names and the highest score of a template of
 *                                        one with the other, by falling score; at most 16, or none yet
 *   ListOtherSensor() -> as              for the same clients: who does not teach the metric because no
 *                                        template was made before the present class of sensor
 *   ResetSite() -> u                     for administrators: no template that is enrolled now teaches
 *                                        the metric any more. They still identify their people, and
 *                                        later enrolments teach. The reply is how many have taught. It
 *                                        is recorded with the user. A second call changes nothing
 *   RollBackSite() -> u                  the same for the last enrolment or import from which the
 *                                        metric still learns, of the last 16; 0: there is none
 *   GetPolicy() -> s document, t revision
 *                                        for administrators, as the next six: who may enter where and
 *                                        when, as a JSON document (isotherm-policy(5)); "" and 0: there
 *                                        is no policy, and whoever is recognised may enter
 *   SetPolicy(s document, t revision) -> t revision, as remarks
 *                                        stores a policy in place of the one of this revision and uses
 *                                        it at once; "" removes it. It is recorded with the user. The
 *                                        reply has the new revision, and the findings of CheckPolicy
 *   CheckPolicy() -> as findings         what in the policy can never let anybody in: one sentence each
 *   TestAccess(s person, s access_point, x time, as shown) -> a{sv}
 *                                        what the door would decide: for a person, at an access point
 *                                        ("": this door) and a time (seconds since 1970), if "face",
 *                                        "card" and "pin" were shown as listed. The reply: "outcome" s
 *                                        ("allow", "deny", "want"), "reason" s (ONVIF's word for a
 *                                        refusal), "wanted" as (what besides), "companion" b (a second
 *                                        person is wanted), "level" s, "access-point" s. It lets nobody in
 *   GetCredential(s person) -> s credential
 *                                        cards, profiles and flags of a person, as JSON
 *                                        (firmware/policy/credential/credential_json.h); no PIN
 *   SetCredential(s person, s patch) -> s credential
 *                                        changes them by a JSON merge patch; recorded with the user
 *   ListCredentials() -> a(ss)           all people who have a stored credential: name and JSON
 *   ReadLog(t from, u max) -> as         audit records from number `from` on, one JSON object each;
 *                                        at most 1000, and only records that are still kept
 *   VerifyLog(t sequence, s head) -> b sound, t first, t last, s head, t flaw_at, s flaw
 *                                        checks every record; sequence and head come from an
 *                                        earlier report; head is "" if there is none
 *   ExportPeople(h file, as people, a{sv} options) -> u people
 *                                        writes a sealed file; an empty list means all people. Options:
 *                                        "to" s, the address of an appliance; else "key" ay, "salt" ay
 *   ImportPeople(h file, a{sv} options) -> u added, u known
 *                                        adds the people of such a file. A person who is known here
 *                                        stays as is, except with "replace" b. Options: "from" s,
 *                                        the address that has to have signed the file; "key" ay
 *   RotateKeys() -> s                    gives gallery, log and anchors new keys; a remark, or "".
 *                                        Records that the log has already keep their old key
 *   GetAddress() -> s                    the address of this appliance, 128 hexadecimal digits
 *   ClearLockout()                       ends a lock-out, clears the count of failures, and accepts
 *                                        the date of a clock that was set back
 *   SetLockdown(b on)                    lets nobody in until it is switched off
 *   TestDoor()                           unlocks the door for half a second; for administrators. It is
 *                                        recorded before it is done. It is refused while a client has the
 *                                        claim, under lockdown or lock-out, if the door is not locked, and
 *                                        if it has no relay or its lines do not work
 *   InstallPanel()                       lets the access panel set its key by the default key for two
 *                                        minutes; for administrators. It is recorded before it is
 *                                        done, and refused if no panel is configured
 *   RecordAct(s account, s act, s person)
 *                                        puts on record that a client does something for one of its
 *                                        own accounts, before the client does it: the event "act"
 *                                        with the person concerned ("": none) and a note that names
 *                                        the act, the account, and the user who runs the client. It
 *                                        fails if the log cannot be written
 *   RecordCommission(s by, a(sss) items) -> s outcome, t sequence
 *                                        for administrators: puts on record what the checks of a door
 *                                        have shown before it goes into service (isotherm doctor
 *                                        --commission). `by` is the name of who checked. An item is its
 *                                        word, its answer (ISO_CONTRACT_ANSWER_...) and a remark, or
 *                                        "". Each is the event "commission" with the answer as the
 *                                        reason and a note "ITEM" or "ITEM: REMARK". One more has the
 *                                        outcome (ISO_CONTRACT_COMMISSION_...) as the reason, and a note
 *                                        with the number of items, the user who calls, and `by`. It is
 *                                        written last, and its sequence is returned; without it the
 *                                        records of items are those of a call that failed
 *   AimStart()  AimStop()                begin and end the sending of View signals to the caller;
 *                                        they also end when the caller leaves the bus
 *   Watch(s what) -> h stream            a socket that receives a record for each frame, as
 *                                        firmware/contract/stream_record.h describes it. `what` is
 *                                        ISO_CONTRACT_WATCH_OUTLINE. The client closes the socket
 *                                        when it has seen enough. Records that it does not read in
 *                                        time are dropped. A user may have four streams
 * + WatchRelief() -> h stream            the same with records of the relief, for clients that may
 *                                        call EnrollStart. It is recorded, and goes on during an
 *                                        action. The daemon closes it at the end of the claim
 * + Picture() -> h file                  a PNG of the next depth frame as shaded relief, at most 320x240
 *                                        pixels: a sealed memory file, which the client reads from its
 *                                        beginning. It is recorded. It is refused while an action goes on,
 *                                        and fails if the camera shows nothing for three seconds
 *
 * An action goes on until a status signal with `done` set. The Stop method ends it before that, and
 * is also legal after it. One client at a time has the claim. No call of a client opens the door,
 * except TestDoor. The daemon's own identification opens it, while nobody has the claim; the exit
 * button opens it at any time. With [login] desk there is no such identification.
 *
 * A name belongs to one person without regard to case ("Ada" and "ada";
 * firmware/contract/person_name.h), and every method accepts any spelling of it. A caller of
 * EnrollStart learns who is enrolled, so it is for clients that may call ListPeople.
 *
 * Signals to the claimant only:
 *   EnrollStatus(s result, b done, u stage, u stages, d quality, s person)
 *       person: for a duplicate, the name under which the face is enrolled; for
 *       "enroll-not-stored", the error of the disk; else ""
 *       stage and stages count the usable frames of all steps that are not left out
 *   EnrollStep(s pose, s state, u step, u steps, d turn_deg)
 *       only of an enrolment with ISO_CONTRACT_POSES: what became of step 1, 2, ... `steps`. pose is
 *       a word ISO_CONTRACT_POSE_..., state a word ISO_CONTRACT_STEP_.... turn_deg: with
 *       ISO_CONTRACT_STEP_TURN, how far the head is from the pose, in degrees; else 0. The frontal
 *       pose is necessary. Every other one is left out if it is not complete in time, or if its
 *       frames do not belong to the frontal face. The signal that step 1 has begun is sent before
 *       the reply of EnrollStart: a client that wants it listens before the call
 *   VerifyStatus, IdentifyStatus(s result, b done, s person, d score, d threshold)
 *       result: "enroll-", "verify-" or "identify-", followed by one of the words
 *       ISO_CONTRACT_RESULT_..., or by "retry-" and a word of isotherm/capture.h. The latter is a
 *       hint, which held for some frames; the action goes on
 * Signal to clients that have called AimStart:
 *   View(a{sv})
 *       what the sensor sees, at most ten times a second: the keys of status_keys.h marked +
 * Signal to the caller of ExportPeople, ImportPeople, RotateKeys or VerifyLog during the call:
 *   Progress(t done, t total)
 *       how much of the work is done. It counts people of an export or an import (which stores
 *       people and then reads everybody back), records of a rotation (people and templates), or
 *       records of the log. At most two signals a second, none in the first half second. `done`
 *       never decreases and is at most `total`, which is above 0 and may decrease
 * Signals to all:
 *   Visit(s verdict, s person, d score, d threshold, u frames, x latency_us, s reason, s door,
 *         s door_fault)
 *       a decision of the door itself: verdict "allow" or "deny", person ("" when unknown), the
 *       best score (NaN: there was nothing to compare with), usable frames, time from the arrival
 *       of the first usable frame to the verdict, reason (a word of firmware/visit/decision.h).
 *       What the door did is separate: door is a word ISO_CONTRACT_DOOR_... after "allow" and ""
 *       after "deny"; door_fault says why the door did not unlock, else it is ""
 *   Hint(s word)
 *       what hinders the person at the door: a word of isotherm/capture.h, which held for some
 *       frames
 *   Wanted(s what)
 *       the policy wants more of the person at the door: a word ISO_CONTRACT_WANTED_...
 *   DoorChanged(s state, s cause)
 *       words of firmware/door/door.h
 *
 * The keys of GetStatus, GetSite and View are in status_keys.h, the methods and the signal of a fleet in
 * fleet_words.h. */
/* clang-format on */
/* A file of exported people begins with ISO_CONTRACT_PEOPLE_MAGIC. The byte at ..._LOCK_AT is
 * ..._PASSPHRASE or ..._APPLIANCE: what opens the file. The key of a passphrase is 32 bytes of
 * Argon2id (crypto_pwhash of libsodium, 3 passes, 256 MiB) with the salt at ..._SALT_AT. */
#ifndef ISO_FIRMWARE_CONTRACT_CONTRACT_H
#define ISO_FIRMWARE_CONTRACT_CONTRACT_H

#include "firmware/contract/log_events.h"
#include "firmware/contract/status_keys.h"

#define ISO_CONTRACT_NAME      "org.isotherm.Isotherm"
#define ISO_CONTRACT_PATH      "/org/isotherm/Door0"
#define ISO_CONTRACT_INTERFACE "org.isotherm.Door"

/* Methods. */
#define ISO_CONTRACT_CLAIM             "Claim"
#define ISO_CONTRACT_RELEASE           "Release"
#define ISO_CONTRACT_ENROLL_START      "EnrollStart"
#define ISO_CONTRACT_ENROLL_STOP       "EnrollStop"
#define ISO_CONTRACT_VERIFY_START      "VerifyStart"
#define ISO_CONTRACT_VERIFY_STOP       "VerifyStop"
#define ISO_CONTRACT_IDENTIFY_START    "IdentifyStart"
#define ISO_CONTRACT_IDENTIFY_STOP     "IdentifyStop"
#define ISO_CONTRACT_VERIFY_SELF       "VerifySelf"
#define ISO_CONTRACT_VERIFY_LOGIN      "VerifyLogin"
#define ISO_CONTRACT_LIST_PEOPLE       "ListPeople"
#define ISO_CONTRACT_DELETE_PERSON     "DeletePerson"
#define ISO_CONTRACT_SET_VALIDITY      "SetValidity"
#define ISO_CONTRACT_RENAME_PERSON     "RenamePerson"
#define ISO_CONTRACT_GET_STATUS        "GetStatus"
#define ISO_CONTRACT_GET_SETTINGS      "GetSettings"
#define ISO_CONTRACT_SET_SETTING       "SetSetting"
#define ISO_CONTRACT_RESET_SETTING     "ResetSetting"
#define ISO_CONTRACT_GET_SITE          "GetSite"
#define ISO_CONTRACT_LIST_LOOK_ALIKES  "ListLookAlikes"
#define ISO_CONTRACT_LIST_OTHER        "ListOtherSensor"
#define ISO_CONTRACT_RESET_SITE        "ResetSite"
#define ISO_CONTRACT_ROLL_BACK_SITE    "RollBackSite"
#define ISO_CONTRACT_GET_POLICY        "GetPolicy"
#define ISO_CONTRACT_SET_POLICY        "SetPolicy"
#define ISO_CONTRACT_CHECK_POLICY      "CheckPolicy"
#define ISO_CONTRACT_TEST_ACCESS       "TestAccess"
#define ISO_CONTRACT_GET_CREDENTIAL    "GetCredential"
#define ISO_CONTRACT_SET_CREDENTIAL    "SetCredential"
#define ISO_CONTRACT_LIST_CREDENTIALS  "ListCredentials"
#define ISO_CONTRACT_READ_LOG          "ReadLog"
#define ISO_CONTRACT_VERIFY_LOG        "VerifyLog"
#define ISO_CONTRACT_EXPORT_PEOPLE     "ExportPeople"
#define ISO_CONTRACT_IMPORT_PEOPLE     "ImportPeople"
#define ISO_CONTRACT_ROTATE_KEYS       "RotateKeys"
#define ISO_CONTRACT_GET_ADDRESS       "GetAddress"
#define ISO_CONTRACT_CLEAR_LOCKOUT     "ClearLockout"
#define ISO_CONTRACT_SET_LOCKDOWN      "SetLockdown"
#define ISO_CONTRACT_TEST_DOOR         "TestDoor"
#define ISO_CONTRACT_INSTALL_PANEL     "InstallPanel"
#define ISO_CONTRACT_AIM_START         "AimStart"
#define ISO_CONTRACT_AIM_STOP          "AimStop"
#define ISO_CONTRACT_WATCH             "Watch"
#define ISO_CONTRACT_RECORD_ACT        "RecordAct"
#define ISO_CONTRACT_RECORD_COMMISSION "RecordCommission"
#define ISO_CONTRACT_WATCH_RELIEF      "WatchRelief"
#define ISO_CONTRACT_PICTURE           "Picture"

/* Options of EnrollStart, and three of SetValidity. */
#define ISO_CONTRACT_ALLOW_DUPLICATE "allow-duplicate"
#define ISO_CONTRACT_POSES           "poses"
#define ISO_CONTRACT_CONSENT         "consent"
#define ISO_CONTRACT_VALID_FROM      "valid-from"
#define ISO_CONTRACT_VALID_UNTIL     "valid-until"
#define ISO_CONTRACT_EXPIRED         "expired"

/* The poses of an enrolment, in the order of its steps. Left and right are the subject's. */
#define ISO_CONTRACT_POSE_FRONTAL "frontal"
#define ISO_CONTRACT_POSE_LEFT    "left"
#define ISO_CONTRACT_POSE_RIGHT   "right"
#define ISO_CONTRACT_POSE_DOWN    "down" /* the chin down */
#define ISO_CONTRACT_POSE_UP      "up"   /* the chin up */

/* The states of a step in EnrollStep. */
#define ISO_CONTRACT_STEP_BEGUN    "begun"
#define ISO_CONTRACT_STEP_TURN     "turn"     /* the head is not yet in the pose; a hint follows */
#define ISO_CONTRACT_STEP_PASSED   "passed"   /* the step is complete */
#define ISO_CONTRACT_STEP_LEFT_OUT "left-out" /* not in time, or its frames are of another face */

/* The stream of Watch. */
#define ISO_CONTRACT_WATCH_OUTLINE "outline"

/* Of the person whose name is in use, in the reply of EnrollStart; and the limits above. */
#define ISO_CONTRACT_PERSON    "person"
#define ISO_CONTRACT_ENROLLED  "enrolled"
#define ISO_CONTRACT_TEMPLATES "templates"

/* Options of ExportPeople and ImportPeople. */
#define ISO_CONTRACT_TO      "to"
#define ISO_CONTRACT_FROM    "from"
#define ISO_CONTRACT_KEY     "key"
#define ISO_CONTRACT_SALT    "salt"
#define ISO_CONTRACT_REPLACE "replace"

/* Files of exported people. */
#define ISO_CONTRACT_PEOPLE_MAGIC "ISOPEOP1"
enum {
    ISO_CONTRACT_PEOPLE_LOCK_AT = 8,
    ISO_CONTRACT_PEOPLE_PASSPHRASE = 1,
    ISO_CONTRACT_PEOPLE_APPLIANCE = 2,
    ISO_CONTRACT_PEOPLE_SALT_AT = 16,
    ISO_CONTRACT_PEOPLE_PASSES = 3,
    ISO_CONTRACT_PEOPLE_MEMORY_BYTES = 256 << 20,
};

/* Most templates of one person, learned ones included; an enrolment beyond that is refused with
 * ISO_CONTRACT_ERROR_GALLERY_FULL. */
enum { ISO_CONTRACT_TEMPLATES_MAX = 16 };

/* Signals. */
#define ISO_CONTRACT_ENROLL_STATUS   "EnrollStatus"
#define ISO_CONTRACT_ENROLL_STEP     "EnrollStep"
#define ISO_CONTRACT_VERIFY_STATUS   "VerifyStatus"
#define ISO_CONTRACT_IDENTIFY_STATUS "IdentifyStatus"
#define ISO_CONTRACT_VISIT           "Visit"
#define ISO_CONTRACT_HINT            "Hint"
#define ISO_CONTRACT_VIEW            "View"
#define ISO_CONTRACT_WANTED          "Wanted"
#define ISO_CONTRACT_DOOR_CHANGED    "DoorChanged"
#define ISO_CONTRACT_PROGRESS        "Progress"

/* Result words after the prefix of the action. */
#define ISO_CONTRACT_RESULT_STAGE_PASSED "stage-passed" /* enroll: the action goes on */
#define ISO_CONTRACT_RESULT_STAGE_MISFIT \
    "stage-misfit" /* enroll: a frame is not used (another face); the action goes on */
#define ISO_CONTRACT_RESULT_COMPLETED "completed" /* enroll */
#define ISO_CONTRACT_RESULT_FAILED    "failed"    /* enroll: several faces, or another fault */
#define ISO_CONTRACT_RESULT_DUPLICATE "duplicate" /* enroll: known under another name */
#define ISO_CONTRACT_RESULT_NOT_STORED \
    "not-stored" /* enroll: an error of the disk; nobody was enrolled */
#define ISO_CONTRACT_RESULT_OTHER_FACE \
    "other-face" /* enroll: unlike the templates enrolled under this name */
#define ISO_CONTRACT_RESULT_MATCH        "match"    /* verify, identify */
#define ISO_CONTRACT_RESULT_NO_MATCH     "no-match" /* verify, identify */
#define ISO_CONTRACT_RESULT_ATTACK       "attack"   /* all: a picture, a screen, a mask */
#define ISO_CONTRACT_RESULT_TIMED_OUT    "timed-out"
#define ISO_CONTRACT_RESULT_DISCONNECTED "disconnected" /* the sensor is gone */
#define ISO_CONTRACT_RESULT_RETRY        "retry-"       /* and a word of isotherm/capture.h */

/* What the door did for somebody who was let in: Visit, and the audit record "visit". */
#define ISO_CONTRACT_DOOR_UNLOCKED     "unlocked"     /* its lock was switched */
#define ISO_CONTRACT_DOOR_OPEN         "open"         /* it stood open already */
#define ISO_CONTRACT_DOOR_NOT_UNLOCKED "not-unlocked" /* its lock could not be switched */

/* Keys of the reply of TestAccess, and the outcomes. */
#define ISO_CONTRACT_ACCESS_OUTCOME   "outcome"
#define ISO_CONTRACT_ACCESS_REASON    "reason"
#define ISO_CONTRACT_ACCESS_WANTED    "wanted"
#define ISO_CONTRACT_ACCESS_COMPANION "companion"
#define ISO_CONTRACT_ACCESS_LEVEL     "level"
#define ISO_CONTRACT_ACCESS_POINT     "access-point"
#define ISO_CONTRACT_ACCESS_ALLOW     "allow"
#define ISO_CONTRACT_ACCESS_DENY      "deny"
#define ISO_CONTRACT_ACCESS_WANT      "want"

/* The answers to an item of RecordCommission: what a program has found, and what a person says. */
#define ISO_CONTRACT_ANSWER_OK      "ok"
#define ISO_CONTRACT_ANSWER_WARNING "warning"
#define ISO_CONTRACT_ANSWER_FAULT   "fault"
#define ISO_CONTRACT_ANSWER_YES     "yes"
#define ISO_CONTRACT_ANSWER_NO      "no"
#define ISO_CONTRACT_ANSWER_SKIPPED "skipped"

/* The outcome of a commissioning. */
#define ISO_CONTRACT_COMMISSION_PASSED     "passed"     /* every answer is "ok" or "yes" */
#define ISO_CONTRACT_COMMISSION_INCOMPLETE "incomplete" /* some are "warning" or "skipped" */
#define ISO_CONTRACT_COMMISSION_FAILED     "failed"     /* there is a "fault" or a "no" */

/* The most items of RecordCommission, and the longest word and remark, in bytes without the NUL. */
enum {
    ISO_CONTRACT_ITEMS_MAX = 64,
    ISO_CONTRACT_ITEM_BYTES = 32,
    ISO_CONTRACT_REMARK_BYTES = 300,
};

/* The longest account and act of RecordAct, in bytes without the NUL. */
enum { ISO_CONTRACT_ACCOUNT_BYTES = 32, ISO_CONTRACT_ACT_BYTES = 32 };

/* Errors: what a call is refused for. A fault of the appliance itself has a code in GetStatus. */
#define ISO_CONTRACT_ERROR_ALREADY_IN_USE   "org.isotherm.Error.AlreadyInUse"
#define ISO_CONTRACT_ERROR_CLAIM_DEVICE     "org.isotherm.Error.ClaimDevice"
#define ISO_CONTRACT_ERROR_NO_SUCH_PERSON   "org.isotherm.Error.NoSuchPerson"
#define ISO_CONTRACT_ERROR_NO_ACTION        "org.isotherm.Error.NoActionInProgress"
#define ISO_CONTRACT_ERROR_ACTION           "org.isotherm.Error.ActionInProgress"
#define ISO_CONTRACT_ERROR_INVALID_NAME     "org.isotherm.Error.InvalidName"
#define ISO_CONTRACT_ERROR_NAME_IN_USE      "org.isotherm.Error.NameInUse"
#define ISO_CONTRACT_ERROR_INVALID_ARGUMENT "org.isotherm.Error.InvalidArgument"
#define ISO_CONTRACT_ERROR_CONFLICT         "org.isotherm.Error.Conflict" /* changed meanwhile */
#define ISO_CONTRACT_ERROR_GALLERY_FULL     "org.isotherm.Error.GalleryFull"
#define ISO_CONTRACT_ERROR_REJECTED         "org.isotherm.Error.Rejected"
#define ISO_CONTRACT_ERROR_LOCKED_OUT       "org.isotherm.Error.LockedOut"
#define ISO_CONTRACT_ERROR_NO_LOGINS        "org.isotherm.Error.NoLogins" /* guards a door */
#define ISO_CONTRACT_ERROR_TOO_MANY_CALLS   "org.isotherm.Error.TooManyCalls"
#define ISO_CONTRACT_ERROR_DEVICE_FAULT     "org.isotherm.Error.DeviceFault"
#define ISO_CONTRACT_ERROR_STORAGE          "org.isotherm.Error.Storage" /* the disk refused */
#define ISO_CONTRACT_ERROR_INTERNAL         "org.isotherm.Error.Internal"

#endif
