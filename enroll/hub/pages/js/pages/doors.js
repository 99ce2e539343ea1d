/* The page Doors: all doors as tiles, by state, zone or name. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h, say} from '../base/dom.js';
import {number} from '../base/format.js';
import {fold, matcher} from '../base/fold.js';
import {faultText} from '../transport/fault.js';
import {choice, input} from '../view/fields.js';
import {doorTile, openDoor} from './door_view.js';
import {addDoor} from './join.js';

const SHOWN = {
    all: N_('All doors'),
    attention: N_('Need attention'),
    offline: N_('Offline'),
    waiting: N_('Have not joined yet'),
};

const TAKES = {
    all: () => true,
    attention: ({ attention }) => attention.length > 0,
    offline: ({ state, online }) => state === 'joined' && !online,
    waiting: ({ state }) => state === 'waiting',
};

function make(context) {
    const { api, hub, may } = context;
    const state = { doors: [], zones: [], drawn: '' };
    const fault = h('p', { class: 'fault', role: 'alert' });
    const count = h('p', { class: 'quiet', role: 'status' }, _('Loading…'));
    const place = h('ul', { class: 'tiles' });
    const search = input({ type: 'search', placeholder: _('Search by name'), 'aria-label': _('Search by name') });
    const shown =
        choice(Object.entries(SHOWN).map(([key, text]) => [key, _(text)]), 'all', { 'aria-label': _('Shown') });
    const zone = h('select', { 'aria-label': _('Zone') });

    function drawZones() {
        const { value } = zone;
        fill(
            zone, h('option', { value: '' }, _('All zones')),
            state.zones.map(({ id, name }) => h('option', { value: id }, name)));
        zone.value = state.zones.some(({ id }) => id === value) ? value : '';
    }

    function draw() {
        const takes = matcher(search.value);
        const found = state.doors.filter(
            (door) => TAKES[shown.value](door) && takes(fold(door.name)) &&
                (!zone.value || door.zones.some(({ id }) => id === zone.value)));
        /* A tile that is drawn anew loses the focus. */
        const text =
            JSON.stringify(found.map(({ reported_s, door_time_s, last_event, stored_events, ...rest }) => rest));
        say(count, _f('{shown} of {all} doors', { shown: number(found.length), all: number(state.doors.length) }));
        if (text !== state.drawn) {
            state.drawn = text;
            fill(place, found.map((door) => doorTile(door, (one) => openDoor(context, one, state.zones, changed))));
        }
    }

    async function load() {
        try {
            [state.doors, state.zones] = await Promise.all([api.doors(), api.zones()]);
            drawZones();
            draw();
            fill(fault);
        } catch (error) {
            fill(fault, faultText(error));
        }
    }
    const changed = () => hub.ask();

    search.addEventListener('input', draw);
    shown.addEventListener('change', draw);
    zone.addEventListener('change', draw);
    const end = hub.on('tick', load);
    load();
    return {
        element:
            h('div', {},
              h('div', { class: 'bar' }, search, shown, zone,
                may('administrator') &&
                    h('button', { type: 'button', onclick: () => addDoor(context, state.zones, changed) },
                      _('Add a door…'))),
              fault, count, place),
        resume: load,
        leave: end,
    };
}

export const doors = {
    id: 'doors',
    title: N_('Doors'),
    least: 'observer',
    make
};
