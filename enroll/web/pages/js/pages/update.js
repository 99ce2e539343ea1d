/* The page Update: which version runs, what both slots have, and an update that is brought as a
 * file. Only an image of the appliance is updated like this; on another machine the page says so. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h, say} from '../base/dom.js';
import {dateTime, percent} from '../base/format.js';
import {Fault, faultText} from '../transport/fault.js';
import {badge} from '../view/badge.js';
import {confirm} from '../view/dialog.js';
import {chooseFile} from '../view/file.js';
import {notice, noticeFault} from '../view/notice.js';
import {stack} from '../view/stack.js';

const AGAIN_MS = 2000;

const HINDRANCES = {
    'no-image': N_(
        'This machine takes no updates by its pages: it is no image of the appliance. It is updated by the packages of its system.'),
    denied: N_('The web server may not ask for the state of updates.'),
    'no-reply': N_('The service for updates (RAUC) does not answer.'),
};

/* Why an update was not installed: the codes of `isotherm update`. */
const REFUSALS = {
    'foreign-key': N_('It is no update, or it is signed with a key that this appliance does not know.'),
    'other-board': N_('It is for another kind of machine.'),
    'not-newer': N_('It is not newer than the version that runs.'),
    'several-updates': N_('There is more than one update on the USB stick. Leave one there.'),
    'too-large': N_('It is too large.'),
    'no-room': N_('The disk of the appliance has no room for this file.'),
    unreadable: N_('It cannot be read from the USB stick.'),
    'on-trial': N_('The version that runs is not yet found to be good. Try again in some minutes.'),
    busy: N_('Another update was being installed.'),
};

const WAYS = {
    page: N_('by these pages'),
    hub: N_('from the hub'),
    stick: N_('from a USB stick')
};

const waiting = (state) => state.slots.find((slot) => slot.next && !slot.running);

/* Sentences of the appliance are English. */
const english = (text) => text && h('span', { class: 'quiet', lang: 'en', dir: 'ltr' }, ` ${text}`);

function slotRow(slot) {
    const states = [
        slot.running && badge('good', _('In use')), slot.next && badge('plain', _('Starts next')),
        !slot.good && badge('bad', _('Cannot be started'))
    ];
    return h(
        'tr', {}, h('th', { scope: 'row' }, h('bdi', {}, slot.slot)), h('td', {}, slot.version ?? _('not known')),
        h('td', {}, states.filter(Boolean).map((state) => [state, ' '])));
}

function machine(state) {
    const row = (name, value) => [h('dt', {}, name), h('dd', {}, value)];
    const head = (text) => h('th', { scope: 'col' }, text);
    return [
        h('dl', { class: 'facts' }, row(_('Version that runs'), state.version ?? _('not known')),
          row(_('Image'), state.image ?? _('not known'))),
        state.slots.length > 0 &&
            h('div', { class: 'scroll' },
              stack(
                  h('table', {}, h('caption', { class: 'unseen' }, _('Slots')),
                    h('thead', {}, h('tr', {}, head(_('Slot')), head(_('Version')), head(_('State')))),
                    h('tbody', {}, state.slots.map(slotRow)))))
    ];
}

function lastUpdate(last) {
    const when = _f('{time}, {way}', { time: dateTime(last.at_s * 1000), way: _(WAYS[last.from] ?? last.from) });
    if (!last.code) {
        return h(
            'p', {}, badge('good', _('Installed')), ' ',
            _f('Version {version} in slot {slot}', { version: last.version ?? '–', slot: last.slot }), ' ',
            h('span', { class: 'quiet' }, `(${when})`));
    }
    const known = REFUSALS[last.code];
    return h(
        'p', {}, badge('bad', _('Not installed')), ' ',
        known ? _(known) : [_('The appliance reports:'), english(last.message)], ' ',
        h('span', { class: 'quiet' }, `(${when})`));
}

/* The file that is sent just now. Returns {element, begin}. begin(state) asks for a file. */
function sender(api, after) {
    const bar = h('progress', { max: 1, value: 0, 'aria-label': _('Progress') });
    const line = h('p', { role: 'status' });
    const stop = h('button', { type: 'button', class: 'plain' }, _('Cancel'));
    const fault = h('p', { class: 'fault', role: 'alert' });
    const element =
        h('div', {}, fault, h('div', { hidden: true }, line, bar, h('div', { class: 'buttons start' }, stop)));
    let controller = null;
    stop.addEventListener('click', () => controller?.abort());
    const check = (file, state) => {
        if (file.size === 0 || file.size > state.most_bytes) {
            throw new Fault(file.size === 0 ? 'incomplete' : 'no-room');
        }
    };
    return {
        element,
        sends: () => controller !== null,
        end: () => controller?.abort(),
        async begin(state) {
            const file = await chooseFile('.raucb');
            if (!file) {
                return;
            }
            fill(fault);
            try {
                check(file, state);
                controller = new AbortController();
                element.lastChild.hidden = false;
                bar.value = 0;
                say(line, _f('Sending {name}', { name: file.name }));
                after();
                await api.bringUpdate(file, (share) => {
                    bar.value = share;
                }, controller.signal);
                notice(_('The update has arrived. The appliance checks it.'));
            } catch (error) {
                if (error.name !== 'AbortError') {
                    fill(fault, faultText(error));
                }
            }
            controller = null;
            element.lastChild.hidden = true;
            after();
        },
    };
}

async function restart(api) {
    const sure = await confirm(
        _('Restart now?'),
        _('The door is out of service for about a minute. Enrolled people and settings stay. If the new version does not work, the former one comes back by itself.'),
        _('Restart'), { danger: true });
    if (sure) {
        await api.restart();
        notice(_('The appliance restarts.'));
    }
}

/* What goes on, and what can be done. */
function work(state, api, sending) {
    const installing = state.operation !== 'idle' || state.handed_over;
    const ready = waiting(state);
    return [
        installing && h('p', { role: 'status' }, _('The update is being checked and installed.')),
        installing && state.operation !== 'idle' &&
            h('div', {}, h('progress', { max: 100, value: state.percent, 'aria-label': _('Progress') }),
              ` ${percent(state.percent / 100)}`),
        !installing && ready &&
            h('p', {},
              _f('Version {version} is installed and starts at the next restart.', { version: ready.version ?? '–' })),
        h('div', { class: 'buttons start' },
          h('button', {
              type: 'button',
              disabled: installing || sending.sends() || state.coming,
              onclick: () => sending.begin(state)
          },
            _('Choose an update…')),
          !installing && ready &&
              h('button', { type: 'button', class: 'danger', onclick: () => restart(api).catch(noticeFault) },
                _('Restart…')))
    ];
}

function make({ api }) {
    const facts = h('div', {}), acts = h('div', {}), last = h('div', {});
    const fault = h('p', { class: 'fault', role: 'alert' });
    let timer = 0, drawn = '', state = null, left = false;
    const sending = sender(api, () => draw());
    const draw = () => {
        const now = JSON.stringify([state, sending.sends()]);
        if (!state || now === drawn) {
            return;
        }
        drawn = now;
        fill(facts, machine(state));
        fill(acts, state.hindrance ? h('p', {}, _(HINDRANCES[state.hindrance])) : work(state, api, sending));
        fill(last, state.last && [h('h3', {}, _('The last update')), lastUpdate(state.last)]);
    };
    const load = async () => {
        clearTimeout(timer);
        try {
            state = await api.update();
            fill(fault);
            draw();
        } catch (error) {
            if (error.code !== 'login-required') {
                say(fault, faultText(error));
            }
        }
        if (!left) {
            timer = setTimeout(load, AGAIN_MS);
        }
    };
    load();
    return {
        element: h(
            'div', {}, fault, h('section', { class: 'panel' }, h('h2', {}, _('This machine')), facts),
            h('section', { class: 'panel' }, h('h2', {}, _('Install an update')),
              h('p', { class: 'quiet' },
                _('An update is a file whose name ends with .raucb. It is also installed from a USB stick that has exactly one file isotherm-….raucb. Only an update that is signed for this appliance and is newer than what runs is installed. The door stays in service meanwhile.')),
              acts, sending.element, last)),
        resume: load,
        leave() {
            left = true;
            clearTimeout(timer);
            sending.end();
        },
    };
}

export const update = {
    id: 'update',
    title: N_('Update'),
    least: 'administrator',
    needs: 'update',
    make
};
