/* The page Overview: the zones, and the doors at which somebody should look. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {number} from '../base/format.js';
import {faultText} from '../transport/fault.js';
import {badge} from '../view/badge.js';
import {stack} from '../view/stack.js';
import {doorTile, openDoor} from './door_view.js';
import {addZone, leaseText, openZone} from './zone.js';

const DOORS_MOST = 60; /* tiles; the page Doors has all */

function tile(page, value, text) {
    return h('li', {}, h('a', { class: 'tile', href: `#${page}` }, h('span', { class: 'big' }, value), text));
}

function numbers({ status }, may) {
    return status &&
        h('ul', { class: 'tiles' },
          tile('doors', `${number(status.doors.online)} / ${number(status.doors.joined)}`, _('Doors online')),
          may('enroller') && tile('people', number(status.people), _('People')),
          may('enroller') && tile('requests', number(status.requests), _('Requests')),
          tile('lockdown', number(status.zones.lockdown), _('Zones in lockdown')));
}

function stateOf(zone, doors) {
    const waiting = doors.filter(
        (door) => door.state === 'joined' && door.zones.some(({ id, confirmed }) => id === zone.id && !confirmed));
    return h(
        'span', { class: 'badges' }, zone.behind && badge('bad', _('Knows less than its doors')),
        zone.lockdown && badge('bad', _('Lockdown')),
        waiting.length > 0 && badge('odd', _f('Not confirmed by doors: {n}', { n: number(waiting.length) })),
        !zone.behind && !zone.lockdown && !waiting.length && badge('good', _('Confirmed by all doors')));
}

function zoneRow(zone, doors, open) {
    return h(
        'tr', {},
        h('th', { scope: 'row' },
          h('button', { type: 'button', class: 'link', onclick: () => open(zone) }, h('bdi', {}, zone.name))),
        h('td', {}, stateOf(zone, doors)), h('td', { class: 'number' }, number(zone.doors)),
        h('td', { class: 'number' }, number(zone.people)), h('td', {}, leaseText(zone.lease_s)));
}

function make(context) {
    const { api, hub, may } = context;
    const fault = h('p', { class: 'fault', role: 'alert' });
    const tiles = h('div', {});
    const body = h('tbody', {});
    const place = h('div', {});
    const head = (text, kind = '') => h('th', { scope: 'col', class: kind }, text);

    async function load() {
        try {
            const [zones, doors] = await Promise.all([api.zones(), api.doors()]);
            const changed = () => hub.ask();
            fill(body, zones.map((zone) => zoneRow(zone, doors, (one) => openZone(context, one, changed))));
            const odd = doors.filter(({ attention }) => attention.length);
            const open = (door) => openDoor(context, door, zones, changed);
            fill(
                place,
                odd.length ? h('ul', { class: 'tiles' }, odd.slice(0, DOORS_MOST).map((door) => doorTile(door, open))) :
                             h('p', { class: 'good' }, '✓ ', _('All doors are well.')),
                odd.length > DOORS_MOST && h('p', {}, h('a', { href: '#doors' }, _('All doors'))));
            fill(fault);
        } catch (error) {
            fill(fault, faultText(error));
        }
        fill(tiles, numbers(hub, may));
    }

    const end = hub.on('tick', load);
    load();
    return {
        element:
            h('div', {}, fault, tiles,
              h('section', { class: 'panel' }, h('h2', {}, _('Zones')),
                h('div', { class: 'scroll' },
                  stack(
                      h('table', {}, h('caption', { class: 'unseen' }, _('Zones')),
                        h('thead', {},
                          h('tr', {}, head(_('Zone')), head(_('State')), head(_('Doors'), 'number'), head(_('People'), 'number'),
                            head(_('Without the hub')))),
                        body))),
                may('administrator') &&
                    h('div', { class: 'buttons start' },
                      h('button', { type: 'button', onclick: () => addZone(context, () => hub.ask()) },
                        _('Add a zone…')))),
              h('section', { class: 'panel' }, h('h2', {}, _('Doors that need attention')), place)),
        resume: load,
        leave: end,
    };
}

export const overview = {
    id: 'overview',
    title: N_('Overview'),
    least: 'observer',
    make
};
