/* The words of the hub in the language of the page. */

import {N_} from './i18n.js';

/* Why somebody should look at a door: `attention` of openapi.json. */
export const ATTENTION = {
    'code-ended': N_('The join address has ended'),
    offline: N_('Offline'),
    silent: N_('Has not reported for minutes'),
    unconfirmed: N_('Has not confirmed the last change'),
    'hub-behind': N_('Knows more than the hub'),
    'door-state': N_('Look at the door'),
    tamper: N_('The housing is open'),
    sensor: N_('The camera does not work'),
    fault: N_('Reports a fault'),
};

export const MEMBERSHIPS = {
    waiting: N_('Has not joined yet'),
    joined: N_('Joined'),
    expelled: N_('Expelled'),
};

/* How far a rollout is, and a door with it: `state` of Rollout and of RolloutDoor. */
export const ROLLOUTS = {
    running: N_('Under way'),
    stopped: N_('Stopped'),
    done: N_('Done'),
    replaced: N_('Replaced by a later one'),
};

export const DOOR_UPDATES = {
    failed: N_('Failed'),
    'went-back': N_('Its former version runs again'),
    told: N_('Was told'),
    fetching: N_('Fetches or installs it'),
    installed: N_('Has installed it'),
    waiting: N_('Was not told yet'),
    unable: N_('Takes no part'),
    healthy: N_('Runs it'),
};

export const FLEET_ROLE_HELP = {
    observer: N_('sees zones, doors, lockdown and updates'),
    enroller: N_('also sees people, and approves requests'),
    administrator: N_('may do everything'),
};

/* What went wrong, by the codes of the hub, where its words are not those of a door. */
export const FLEET_FAULTS = {
    busy: N_('The hub is busy. Please try again.'),
    'done-before': N_('This was done before.'),
    'door-expelled': N_('The door is expelled.'),
    internal: N_('The hub reported an error.'),
    'invalid-policy': N_('This policy is not allowed.'),
    'invalid-value': N_('This value is not allowed.'),
    'name-in-use': N_('This name is taken.'),
    'no-connection': N_('The hub does not answer.'),
    'no-database': N_('The database of the hub does not answer.'),
    'no-such-door': N_('There is no such door any more.'),
    'no-such-person': N_('There is no such person any more.'),
    'no-such-request': N_('There is no such request any more.'),
    'no-such-update': N_('The hub does not keep this version any more.'),
    'no-such-zone': N_('There is no such zone any more.'),
    'other-rollout': N_('The zone has another rollout now. Look at it first.'),
    'zone-behind': N_('The database was restored from an old copy: recover the zone first.'),
};
