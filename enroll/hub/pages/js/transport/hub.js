/* The API of the hub: enroll/hub/api/openapi.json. */

import {N_, _} from '../base/i18n.js';
import {FLEET_ROLE_HELP} from '../base/fleet_words.js';
import {ask, onLoginRequired, part, query} from './ask.js';

const SETUP_HELP = N_('The command "sudo isotherm-hub setup-code" on the hub shows it.');

export const hub = {
    kind: 'hub',
    can: {accounts: true, login: true},
    roleHelp: FLEET_ROLE_HELP,
    setupHelp: () => _(SETUP_HELP),
    onLoginRequired,

    session: () => ask('GET', '/session'),
    login: (account, password) => ask('POST', '/session', {account, password}),
    logout: () => ask('DELETE', '/session'),
    changePassword: (old, fresh) => ask('PUT', '/session/password', {old, new: fresh}),
    setup: (code, account, password) => ask('POST', '/setup', {code, account, password}),

    accounts: async () => (await ask('GET', '/accounts')).accounts ?? [],
    addAccount: (name, password, role) => ask('POST', '/accounts', {name, password, role}),
    changeAccount: (name, change) => ask('PATCH', `/accounts/${part(name)}`, change),
    removeAccount: (name) => ask('DELETE', `/accounts/${part(name)}`),

    status: () => ask('GET', '/status'),
    zones: async () => (await ask('GET', '/zones')).zones,
    addZone: (name) => ask('POST', '/zones', {name}),
    changeZone: (id, change) => ask('PATCH', `/zones/${part(id)}`, change),
    renewZone: (id) => ask('POST', `/zones/${part(id)}/epoch`, {}),
    recoverZone: (id) => ask('POST', `/zones/${part(id)}/recovery`, {}),
    lockdown: async () => (await ask('GET', '/lockdown')).zones,
    setLockdown: async (on, zone) => (await ask('PUT', '/lockdown', zone ? {on, zone} : {on})).zones,

    updates: () => ask('GET', '/updates'),
    turnRollout: (zone, id, running) => ask('PATCH', `/zones/${part(zone)}/rollout`, {id, running}),
    rollout: async (zone) => (await ask('GET', `/zones/${part(zone)}/rollout`)).doors,

    doors: async () => (await ask('GET', '/doors')).doors,
    door: (id) => ask('GET', `/doors/${part(id)}`),
    addDoor: (name, zones) => ask('POST', '/doors', {name, zones}),
    moveDoor: (id, zones) => ask('PATCH', `/doors/${part(id)}`, {zones}),
    newCode: (id) => ask('POST', `/doors/${part(id)}/code`, {}),
    expelDoor: (id) => ask('DELETE', `/doors/${part(id)}`),

    /* {search, zone, unseen, after, max} */
    people: (wanted) => ask('GET', `/people${query(wanted)}`),
    changePerson: (id, change) => ask('PATCH', `/people/${part(id)}`, change),
    revokePerson: (id) => ask('DELETE', `/people/${part(id)}`),

    requests: async () => (await ask('GET', '/requests')).requests,
    approve: (id, zones) => ask('POST', `/requests/${part(id)}/approval`, zones ? {zones} : {}),
    reject: (id) => ask('DELETE', `/requests/${part(id)}`),

    /* {door, person, event, since, until, before, max} */
    events: (wanted) => ask('GET', `/events${query(wanted)}`),
};
