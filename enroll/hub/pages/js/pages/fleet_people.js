/* The page People: who is one of the fleet, in which zones, and until when. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h, say} from '../base/dom.js';
import {limit, number} from '../base/format.js';
import {faultText} from '../transport/fault.js';
import {badge} from '../view/badge.js';
import {checkbox, input} from '../view/fields.js';
import {stack} from '../view/stack.js';
import {openFleetPerson} from './fleet_person.js';

const PAGE = 100;

function row(person, open) {
    const nowS = Date.now() / 1000;
    const ended = person.valid_until_s > 0 && person.valid_until_s <= nowS;
    return h(
        'tr', {},
        h('th', { scope: 'row' },
          h('button', { type: 'button', class: 'link', onclick: () => open(person) }, h('bdi', {}, person.name))),
        h('td', {}, h('bdi', {}, person.zones.map(({ name }) => name).join(', '))),
        h('td', {}, limit(person.valid_from_s)),
        h('td', {}, limit(person.valid_until_s), ended && [' ', badge('odd', _('ended'))]),
        h('td', {}, person.offline_ok ? _('yes') : _('no')));
}

function make(context) {
    const { api, hub } = context;
    const state = { next: null, n: 0, turn: 0, zones: [] };
    const body = h('tbody', {});
    const fault = h('p', { class: 'fault', role: 'alert' });
    const count = h('p', { class: 'quiet', role: 'status' }, _('Loading…'));
    const search = input(
        { type: 'search', placeholder: _('Search by name'), 'aria-label': _('Search by name'), spellcheck: 'false' });
    const zone = h('select', { 'aria-label': _('Zone') }, h('option', { value: '' }, _('All zones')));
    const unseen = checkbox(_('Only who must be seen again'));
    const more =
        h('button', { type: 'button', class: 'plain', hidden: true, onclick: () => load(false) }, _('Load more'));

    const open = (person) => openFleetPerson(context, person, state.zones, () => {
        load(true);
        hub.ask();
    });

    async function load(anew) {
        state.turn += 1;
        const { turn } = state;
        more.disabled = true;
        try {
            const wanted = {
                search: search.value.trim(),
                zone: zone.value,
                unseen: unseen.box.checked ? '1' : '',
                after: anew ? '' : state.next,
                max: PAGE
            };
            const { people, next } = await api.people(wanted);
            if (turn !== state.turn) {
                return;
            }
            const rows = people.map((person) => row(person, open));
            if (anew) {
                fill(body, rows);
                state.n = 0;
            } else {
                body.append(...rows);
            }
            state.n += people.length;
            state.next = next;
            more.hidden = next === null;
            say(count,
                next === null ? _f('People: {all}', { all: number(state.n) }) :
                                _f('Shown: {n}', { n: number(state.n) }));
            fill(fault);
        } catch (error) {
            fill(fault, faultText(error));
        } finally {
            more.disabled = false;
        }
    }

    async function loadZones() {
        try {
            state.zones = await api.zones();
            fill(
                zone, h('option', { value: '' }, _('All zones')),
                state.zones.map(({ id, name }) => h('option', { value: id }, name)));
        } catch {
            /* the list of people says what is wrong */
        }
    }

    let timer = 0;
    search.addEventListener('input', () => {
        clearTimeout(timer);
        timer = setTimeout(() => load(true), 250);
    });
    zone.addEventListener('change', () => load(true));
    unseen.box.addEventListener('change', () => load(true));
    loadZones();
    load(true);
    const end = hub.on('connection', (up) => up && load(true));
    const head = (text) => h('th', { scope: 'col' }, text);
    return {
        element:
            h('div', {}, h('div', { class: 'bar' }, search, zone, unseen.element), fault, count,
              h('div', { class: 'panel scroll', tabindex: 0, role: 'region', 'aria-label': _('People') },
                stack(
                    h('table', {}, h('caption', { class: 'unseen' }, _('People')),
                      h('thead', {},
                        h('tr', {}, head(_('Name')), head(_('Zones')), head(_('Valid from')), head(_('Valid until')),
                          head(_('Also offline')))),
                      body))),
              h('div', { class: 'buttons start' }, more)),
        resume: () => load(true),
        leave() {
            state.turn += 1;
            clearTimeout(timer);
            end();
        },
    };
}

export const fleetPeople = {
    id: 'people',
    title: N_('People'),
    least: 'enroller',
    make
};
