/* The words of the policy: what is shown at a door, why a door would refuse, and what is wrong with
 * what was typed. */

import {N_} from './i18n.js';

/* What a person shows: firmware/contract/status_keys.h. */
export const METHODS = {
    face: N_('face'),
    card: N_('card'),
    pin: N_('PIN'),
};

/* Why TestAccess would refuse: iso_access_reason_name() in firmware/policy/decide.c. */
export const REFUSALS = {
    Other: N_('Another reason'),
    CredentialNotFound: N_('Nobody has this name'),
    CredentialNotEnabled: N_('Access is suspended'),
    CredentialNotActive: N_('The limits of the person have not begun'),
    CredentialExpired: N_('The limits of the person have ended'),
    Unauthorized: N_('Never at this door'),
    NotPermittedAtThisTime: N_('Outside the schedule'),
    'pt:InvalidIdentifierValue': N_('Wrong card or PIN'),
    InvalidPIN: N_('Wrong card or PIN'),
    'isotherm:AntipassbackViolation': N_('Inside already'),
    'isotherm:NoPair': N_('Not allowed together'),
    'isotherm:NoLease': N_('The hub has not answered for too long'),
    'isotherm:NotApproved': N_('Not approved by the hub yet'),
};

/* What happens when somebody enters who is inside already. */
export const ANTIPASSBACK = {
    none: N_('none'),
    soft: N_('reported'),
    hard: N_('refused'),
    timed: N_('refused for some time'),
};

/* When another level holds. */
export const STATES = {
    active: N_('{level} while {schedule} is active'),
    inactive: N_('{level} while {schedule} is not active'),
    special_active: N_('{level} on special days while {schedule} is active'),
    special_inactive: N_('{level} on special days while {schedule} is not active'),
};

/* Why what was typed is refused: policy.js. */
export const POLICY_FLAWS = {
    'period-wrong': N_('A period is written as 09:00-17:30, and ends on the same day, at 24:00 at the latest.'),
    'periods-overlap': N_('Periods of a day follow each other and do not overlap.'),
    'too-many-periods': N_('A day has at most 8 periods.'),
    'date-wrong': N_('A date is written as 2026-12-25.'),
    'too-many-dates': N_('A group has at most 64 dates.'),
};
