/* The words of the daemon and the web server in the language of the page. A word that this table
 * does not know is shown as it is: a newer daemon may have further ones. The terms are those of the
 * screen for visitors (enroll/screen/scene/words.c) where both say the same. */

import {N_, _} from './i18n.js';

const OWN_FACE = N_('Show your own face');

/* What became of a frame: isotherm/capture.h. The person in front of the camera is addressed. */
export const HINTS = {
    'no-face': N_('Look straight at the camera'),
    ok: N_('Good. Hold still'),
    'too-far': N_('Come closer'),
    'too-close': N_('Step back a little'),
    'move-left': N_('Move a little to your left'),
    'move-right': N_('Move a little to your right'),
    'move-up': N_('Come up a little'),
    'move-down': N_('Come down a little'),
    'turn-left': N_('Turn your head to the left'),
    'turn-right': N_('Turn your head to the right'),
    'look-up': N_('Raise your chin'),
    'look-down': N_('Lower your chin'),
    'too-few-points': N_('Keep hair and hands off your face'),
    'covered-brow': N_('Show your forehead'),
    'covered-eyes': N_('Take off your glasses'),
    'covered-nose': N_('Show your nose'),
    'covered-mouth': N_('Take off your mask or scarf'),
    'covered-left': N_('Show the left side of your face'),
    'covered-right': N_('Show the right side of your face'),
    'several-faces': N_('One person at a time'),
    'not-a-face': N_('Look straight at the camera'),
    moving: N_('Hold still'),
    expression: N_('Close your mouth and look calm'),
    nobody: N_('Nobody is there'),
    flat: OWN_FACE,
    bent: OWN_FACE,
    screen: OWN_FACE,
    'wrong-size': OWN_FACE,
    'eyes-cut': OWN_FACE,
    still: OWN_FACE,
    'no-face-in-image': N_('Look straight at the camera'),
};

/* Reasons of a verdict: firmware/visit/decision.h. They are for the people who run the door. */
export const REASONS = {
    none: N_('No reason'),
    match: N_('Recognised'),
    unknown: N_('Not recognised'),
    left: N_('Went away too early'),
    'not-valid': N_('Not at this time'),
    unlogged: N_('The log could not be written'),
    attack: N_('Looked like a picture, a screen or a mask'),
    'locked-out': N_('Locked out after too many attempts'),
    lockdown: N_('Lockdown'),
    'no-gallery': N_('The list of people is out of service'),
    'no-lockout': N_('The lock-out file cannot be read'),
    'not-on-record': N_('Not recorded in time'),
    stale: N_('The measurement was too old'),
    open: N_('Open to everybody at this time'),
    credential: N_('By card or PIN alone'),
    disabled: N_('Access is suspended'),
    'not-here': N_('Never at this door'),
    'not-now': N_('Outside the schedule'),
    'not-enough': N_('Card, PIN or second person missing'),
    'wrong-factor': N_('Wrong card or PIN'),
    antipassback: N_('Inside already'),
    'no-pair': N_('Not allowed together'),
    'no-policy': N_('The policy could not be used'),
    'no-lease': N_('The hub has not answered for too long'),
    'not-approved': N_('Not approved by the hub yet'),
};

/* What the policy wants besides of the person at the door, and what this person does for it: the
 * texts of the screen for visitors. */
export const WANTED = {
    face: N_('Look at the camera'),
    card: N_('Show your card'),
    pin: N_('Type your PIN'),
    person: N_('Two people are needed'),
};

export const WANTED_ADVICE = {
    face: N_('Your face is needed, too'),
    card: N_('Hold it to the reader'),
    pin: N_('End it with the # key'),
    person: N_('The second one looks at the camera now'),
};

/* What an attack looked like: the cues of isotherm/capture.h, for the people who run the door. */
export const CUES = {
    flat: N_('a flat picture'),
    bent: N_('a bent picture'),
    screen: N_('a screen'),
    'wrong-size': N_('a face of the wrong size'),
    'eyes-cut': N_('a mask with holes for the eyes'),
    still: N_('a face that does not live'),
    'no-face-in-image': N_('no face in the picture of the camera'),
};

export const VERDICTS = {
    allow: N_('Let in'),
    deny: N_('Refused')
};

/* firmware/door/door.h. */
export const DOOR_STATES = {
    stopped: N_('Stopped'),
    locked: N_('The door is locked'),
    unlocked: N_('The door is unlocked'),
    opened: N_('The door is open'),
    'held-open': N_('The door is open for too long'),
    forced: N_('The door was forced open'),
    fault: N_('Out of order'),
};

export const DOOR_CAUSES = {
    start: N_('Start'),
    'start-open': N_('Start with an open door'),
    stop: N_('Stop'),
    grant: N_('Somebody was let in'),
    refuse: N_('Somebody was refused'),
    test: N_('Test of the relay'),
    'exit-button': N_('Exit button'),
    opened: N_('The door was opened'),
    closed: N_('The door was closed'),
    tamper: N_('The housing was opened'),
    'tamper-ended': N_('The housing was closed'),
    fault: N_('A fault'),
    recovered: N_('The fault is over'),
    'not-switched': N_('The lock could not be switched'),
    time: N_('Time ran out'),
};

/* What the door did for somebody who was let in. */
export const DOOR_ACTS = {
    unlocked: N_('Unlocked'),
    open: N_('Stood open already'),
    'not-unlocked': N_('Did not unlock'),
};

export const MODES = {
    watch: N_('Watches the door'),
    claimed: N_('The camera is in use'),
    enroll: N_('Enrols a person'),
    verify: N_('Verifies a person'),
    identify: N_('Identifies a person'),
};

export const SENSOR_STATES = {
    started: N_('Works'),
    silent: N_('Delivers nothing'),
    repeats: N_('Repeats earlier frames'),
    lost: N_('Not connected'),
};

/* Results of an enrolment: ISO_CONTRACT_RESULT_..., and those of the web server. */
export const RESULTS = {
    'stage-passed': N_('One frame is complete'),
    'stage-misfit': N_('This frame shows another face and is not used'),
    completed: N_('The person is enrolled'),
    failed: N_('Nobody was enrolled: the frames do not show one face'),
    duplicate: N_('Nobody was enrolled: the face is enrolled already'),
    'not-stored': N_('Nobody was enrolled: the disk reported an error'),
    'other-face': N_('Nobody was enrolled: the face is unlike the one that has this name'),
    match: N_('Recognised'),
    'no-match': N_('Not recognised'),
    attack: N_('Nobody was enrolled: it looked like a picture, a screen or a mask'),
    'timed-out': N_('Nobody was enrolled: it took too long'),
    disconnected: N_('Nobody was enrolled: the camera is gone'),
    stopped: N_('Nobody was enrolled: the enrolment was stopped'),
    left: N_('Nobody was enrolled: the page was closed'),
};

export const POSES = {
    frontal: N_('Look straight at the camera'),
    left: N_('Turn your head a little to the left'),
    right: N_('Turn your head a little to the right'),
    down: N_('Lower your chin a little'),
    up: N_('Raise your chin a little'),
};

export const STEP_STATES = {
    begun: N_('begun'),
    turn: N_('not yet in this pose'),
    passed: N_('complete'),
    'left-out': N_('left out'),
};

export const ROLES = {
    observer: N_('Observer'),
    enroller: N_('Enroller'),
    administrator: N_('Administrator'),
};

export const ROLE_HELP = {
    observer: N_('sees the door and the health of the appliance'),
    enroller: N_('also enrols people and sees who is enrolled'),
    administrator: N_('may do everything'),
};

/* States of a finding of the health page. */
export const FINDINGS = {
    good: N_('Good'),
    odd: N_('Notice'),
    denied: N_('Not permitted'),
    bad: N_('Fault'),
};

/* Why a row or a file of people cannot be used: people_csv.js. */
export const IMPORT_FLAWS = {
    'not-csv': N_('This is no CSV file: a quotation mark is missing.'),
    'no-name-column': N_('The file has no column "name".'),
    'no-limit-columns': N_('The file has none of the columns "valid_from", "valid_until" and "cards".'),
    'name-missing': N_('the name is missing'),
    'name-twice': N_('the name is there twice'),
    'valid-from-wrong': N_('valid_from is no time'),
    'valid-until-wrong': N_('valid_until is no time'),
    'cards-wrong': N_('cards are separated by blanks and written as 17/4711 or 56:04a2b3c4d5e6f7, at most 4'),
    'limits-reversed': N_('valid_until is not after valid_from'),
};

/* The word in the language of the page, or as it is; "" for none. */
export function word(table, key) {
    if (key === undefined || key === null) {
        return '';
    }
    return Object.hasOwn(table, key) ? _(table[key]) : String(key);
}
