/* One door of the fleet: its tile, and the dialog with all that is known of it. */

import {_, _f} from '../base/i18n.js';
import {h} from '../base/dom.js';
import {dateTime, number} from '../base/format.js';
import {DOOR_STATES, SENSOR_STATES, word} from '../base/words.js';
import {ATTENTION, MEMBERSHIPS} from '../base/fleet_words.js';
import {badge} from '../view/badge.js';
import {confirm, form, openDialog} from '../view/dialog.js';
import {notice, noticeFault} from '../view/notice.js';
import {showWaiting} from '../view/waiting.js';
import {zoneChoice} from '../view/zone_choice.js';
import {showJoin} from './join.js';

/* What a tile says first. */
function stateBadge(door) {
    if (door.state !== 'joined') {
        return badge('plain', word(MEMBERSHIPS, door.state));
    }
    return door.online ? badge('good', _('Online')) : badge('bad', _('Offline'));
}

export function doorKind(door) {
    if (door.state !== 'joined') {
        return door.attention.length ? 'odd' : '';
    }
    const mild = ['unconfirmed', 'silent', 'code-ended'];
    return door.attention.some((one) => !mild.includes(one)) ? 'bad' : door.attention.length ? 'odd' : 'good';
}

export function doorTile(door, open) {
    const state = door.state === 'joined' && word(DOOR_STATES, door.health['door-state']);
    return h(
        'li', {},
        h('button', { type: 'button', class: `tile ${doorKind(door)}`, onclick: () => open(door) },
          h('span', { class: 'name' }, h('bdi', {}, door.name)), stateBadge(door),
          door.attention.filter((one) => one !== 'offline')
              .map((one) => h('span', { class: 'quiet' }, word(ATTENTION, one))),
          !door.attention.length && state && h('span', { class: 'quiet' }, state),
          h('span', { class: 'quiet' }, h('bdi', {}, door.zones.map(({ name }) => name).join(', ')))));
}

const shown = (value) => (typeof value === 'object' ? JSON.stringify(value) : String(value));

function facts(door) {
    const row = (name, value) => [h('dt', {}, name), h('dd', {}, value)];
    const time = (seconds) => (seconds ? dateTime(seconds * 1000, true) : '–');
    const { health } = door;
    return h(
        'dl', { class: 'facts' },
        row(_('State'),
            h('span', { class: 'badges' }, stateBadge(door),
              door.attention.filter((one) => one !== 'offline').map((one) => badge('odd', word(ATTENTION, one))))),
        row(_('Zones'),
            h('ul', { class: 'doors-waiting' },
              door.zones.map(
                  (zone) => h(
                      'li', {}, h('bdi', {}, zone.name),
                      door.state === 'joined' &&
                          h('span', { class: 'quiet' }, ` ${zone.confirmed ? _('confirmed') : _('not confirmed')}`))))),
        door.state === 'waiting' && row(_('The join address holds until'), time(door.code_until_s)),
        door.state === 'joined' && [
            row(_('Joined'), time(door.joined_s)),
            row(_('Last report'), time(door.reported_s)),
            row(_('Clock of the door'), time(door.door_time_s)),
            row(_('Records of the log'),
                _f('{stored} of {all} are at the hub',
                   { stored: number(door.stored_events), all: number(Math.max(door.last_event, door.stored_events)) })),
            health['door-state'] && row(_('Door'), word(DOOR_STATES, health['door-state'])),
            health['sensor-state'] && row(_('Camera'), word(SENSOR_STATES, health['sensor-state'])),
            health.people !== undefined && row(_('People'), number(health.people)),
            health.fault && row(_('Fault'), h('span', { class: 'fault', lang: 'en' }, health.fault)),
        ]);
}

function allHealth({ health }) {
    const rows = Object.entries(health);
    return rows.length > 0 &&
        h('details', {}, h('summary', {}, _('All that the door tells')),
          h('dl', { class: 'facts', lang: 'en', dir: 'ltr' },
            rows.map(
                ([key, value]) => [h('dt', {}, h('code', {}, key)), h('dd', {}, h('code', {}, shown(value) || '–'))])));
}

function buttons(door, close) {
    const button = (value, text, kind = 'plain') =>
        h('button', { type: 'button', class: kind, onclick: () => close(value) }, text);
    return h(
        'div', { class: 'buttons start' }, button('code', _('New join address…')), button('move', _('Zones…')),
        button('expel', _('Expel…'), 'danger'));
}

async function move({ api }, door, zones) {
    const picked = zoneChoice(zones, door.zones.map(({ id }) => id));
    return await openDialog(
        _f('Zones of {name}', { name: door.name }),
        (close) => form(
            [h('p', {}, _('Zones that the door leaves get new keys.')), picked.element], _('Save'),
            () => api.moveDoor(door.id, picked.read()), () => close(true), { cancel: () => close() }));
}

async function expel({ api }, door) {
    if (!await confirm(
            _f('Expel {name}?', { name: door.name }),
            _('The door belongs to the fleet no more. Its messages are refused, and its zones get new keys, which it does not have.'),
            _f('Expel {name}', { name: door.name }), { danger: true })) {
        return false;
    }
    const { zones } = await api.expelDoor(door.id);
    await showWaiting(
        api, _f('{name} is expelled.', { name: door.name }), _('These doors do not have the new keys yet:'), zones);
    return true;
}

async function code({ api }, door) {
    await showJoin(await api.newCode(door.id));
    return false;
}

/* Shows a door; changed() is called after a change. */
export async function openDoor(context, {id}, zones, changed) {
    let door;
    try {
        door = await context.api.door(id);
    } catch (error) {
        noticeFault(error);
        return;
    }
    const result = await openDialog(
        door.name,
        (close) =>
            [facts(door), allHealth(door),
             context.may('administrator') && door.state !== 'expelled' && buttons(door, close),
             h('div', { class: 'buttons' },
               h('button', { type: 'button', class: 'plain', autofocus: true, onclick: () => close() }, _('Close')))]);
    const acts = { move, expel, code };
    try {
        if (acts[result] && await acts[result](context, door, zones)) {
            notice(_('Saved.'));
        }
    } catch (error) {
        noticeFault(error);
    }
    if (acts[result]) {
        changed();
    }
}
