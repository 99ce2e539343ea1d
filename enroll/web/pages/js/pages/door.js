/* The page Door: what the camera sees, the state of the door, and who came. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h, say} from '../base/dom.js';
import {centimetres, dateTime, timeOfDay} from '../base/format.js';
import {
    DOOR_ACTS,
    DOOR_CAUSES,
    DOOR_STATES,
    HINTS,
    MODES,
    REASONS,
    SENSOR_STATES,
    VERDICTS,
    WANTED,
    WANTED_ADVICE,
    word
} from '../base/words.js';
import {faultText} from '../transport/fault.js';
import {badge} from '../view/badge.js';
import {holdHint} from '../view/hint_hold.js';
import {outlineView} from '../view/outline_view.js';
import {stack} from '../view/stack.js';
import {lockControls} from './lock_controls.js';

const QUIET_MS = 3000; /* without a frame the picture is old */

/* The live picture, which rests while nobody sees the page. */
function live(api) {
    const view = outlineView(_('Outline of the person at the door'));
    const hint = h('p', { class: 'hint', 'aria-live': 'polite' });
    const distance = h('p', { class: 'quiet' });
    const hold = holdHint((text) => say(hint, text || '\u00a0'));
    let stream = null;
    let last = 0;
    let empty = true;
    let refused = '';
    const draw = (record) => {
        last = performance.now();
        view.draw(record);
        if (record.verdict === 'wait') {
            hold(word(WANTED, record.reason), true);
            say(distance, word(WANTED_ADVICE, record.reason));
            return;
        }
        /* Without a face "ok" means that there is nothing to say. */
        const nobody = record.hint === 'nobody' || (!record.distanceMm && (record.hint === 'ok' || record.hint === ''));
        hold(nobody ? _('Nobody is there') : word(HINTS, record.hint), empty && !nobody);
        empty = nobody;
        say(distance,
            record.distanceMm ? _f('Distance: {length}', { length: centimetres(record.distanceMm) }) : '\u00a0');
    };
    const follow = () => {
        stream?.close();
        stream = document.hidden ? null : api.outline(draw, (up, fault) => {
            refused = fault?.code === 'not-allowed' ? faultText(fault) : '';
        });
    };
    const watch = setInterval(() => {
        if (!document.hidden && performance.now() - last > QUIET_MS) {
            view.draw(null);
            hold(refused || _('The camera shows nothing at the moment'));
            say(distance, '\u00a0');
        }
    }, 1000);
    document.addEventListener('visibilitychange', follow);
    follow();
    return {
        element:
            h('section', { class: 'panel live', 'aria-label': _('At the door now') }, api.can.outline && view.element,
              hint, distance),
        resume: follow,
        leave() {
            stream?.close();
            clearInterval(watch);
            document.removeEventListener('visibilitychange', follow);
        },
    };
}

function doorKind(state) {
    return { locked: 'good', unlocked: 'good', opened: 'plain' }[state] ?? (state ? 'bad' : 'plain');
}

function stateList({ hub }) {
    const list = h('dl', { class: 'facts' });
    let cause = '';
    const row = (name, ...value) => [h('dt', {}, name), h('dd', {}, value)];
    const draw = () => {
        const s = hub.status;
        if (hub.daemon !== true) {
            fill(
                list,
                row(_('State'),
                    badge(
                        'plain',
                        hub.daemon === false ? _('The door service does not run.') : _('One moment, please'))));
            return;
        }
        const sensor = s['sensor-state'];
        fill(
            list,
            row(_('Door'), badge(doorKind(s['door-state']), word(DOOR_STATES, s['door-state']) || '–'),
                cause && h('span', { class: 'quiet' }, ` ${cause}`)),
            row(_('Camera'), badge(sensor === 'started' ? 'good' : 'bad', word(SENSOR_STATES, sensor) || '–')),
            row(_('Doing'), word(MODES, s.mode) || '–'),
            row(_('Lockdown'), s.lockdown ? badge('bad', _('On')) : _('Off')),
            row(_('Lock-out'), s['lockout-ms'] > 0 ? badge('bad', _('On')) : _('Off')),
            row(_('Lines'), s['door'] === 'null' ? _('none: the door is simulated') : s['door-lines'] || '–'));
    };
    const ends = [
        hub.on('changed', draw),
        hub.on(
            'door',
            (event) => {
                cause = word(DOOR_CAUSES, event?.cause);
                draw();
            })
    ];
    draw();
    return { element: list, leave: () => ends.forEach((end) => end()) };
}

/* What a visit says about its end: the verdict, the reason of a refusal, what the door did. */
export function visitWords(visit) {
    const allowed = visit.verdict === 'allow';
    const reason = allowed ? '' : word(REASONS, visit.reason);
    const act = allowed ? word(DOOR_ACTS, visit.door) : '';
    return {
        allowed,
        verdict: word(VERDICTS, visit.verdict),
        more: [reason, act, visit.door_fault].filter(Boolean).join(' · ')
    };
}

function visitRow(visit) {
    const { allowed, verdict, more } = visitWords(visit);
    return h(
        'tr', {},
        h('td', {}, h('time', { datetime: visit.time, title: dateTime(visit.time, true) }, timeOfDay(visit.time))),
        h('td', {}, badge(allowed ? 'good' : 'bad', verdict)),
        h('td', {}, visit.person ? h('bdi', {}, visit.person) : h('span', { class: 'quiet' }, _('unknown'))),
        h('td', {}, more));
}

function visits({ api, hub, may }) {
    const body = h('tbody', { 'aria-live': 'polite', 'aria-relevant': 'additions' });
    const empty = h('p', { class: 'quiet' }, _('No visits yet.'));
    const add = (visit) => {
        body.prepend(visitRow(visit));
        empty.hidden = true;
        while (body.children.length > 50) {
            body.lastChild.remove();
        }
    };
    hub.visits.toReversed().forEach(add);
    const end = hub.on('visit', add);
    if (may('administrator') && !hub.visits.length) {
        /* Those before this page was opened are in the log. */
        api.log({ max: 200 })
            .then(({ records = [] }) => {
                const earlier = records.filter((record) => record.event === 'visit').slice(-20);
                hub.visits = [...hub.visits, ...earlier.toReversed()];
                body.append(...earlier.toReversed().map(visitRow));
                empty.hidden = body.children.length > 0;
            })
            .catch(() => {});
    }
    const head = (text) => h('th', { scope: 'col' }, text);
    return {
        element:
            h('section', { class: 'panel' }, h('h2', {}, _('Last visits')),
              h('div', { class: 'scroll' },
                stack(
                    h('table', {},
                      h('thead', {},
                        h('tr', {}, head(_('Time')), head(_('Verdict')), head(_('Person')), head(_('Reason')))),
                      body))),
              empty),
        leave: end,
    };
}

export const door = {
    id: 'door',
    title: N_('Door'),
    least: 'observer',
    make(context) {
        const picture = live(context.api);
        const state = stateList(context);
        const controls = lockControls(context);
        const last = visits(context);
        return {
            element:
                h('div', { class: 'columns' }, picture.element,
                  h('section', { class: 'panel' }, h('h2', {}, _('State')), state.element, controls.element),
                  last.element),
            resume: picture.resume,
            leave() {
                picture.leave();
                state.leave();
                controls.stop();
                last.leave();
            },
        };
    },
};
