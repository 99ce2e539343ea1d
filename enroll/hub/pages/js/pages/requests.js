/* The page Requests: people who were enrolled at a door and wait for approval. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {dateTime} from '../base/format.js';
import {faultText} from '../transport/fault.js';
import {confirm, form, openDialog} from '../view/dialog.js';
import {notice, noticeFault} from '../view/notice.js';
import {stack} from '../view/stack.js';
import {zoneChoice} from '../view/zone_choice.js';

/* Only an administrator chooses zones; for others it is the home zone of the door. */
async function approveAtHome(api, request, home) {
    if (!await confirm(
            _f('Approve {name}', { name: request.name }),
            home ? _f('All doors of the zone {zone} will know the person.', { zone: home.name }) :
                   _('The door has no zone any more; an administrator must choose one.'),
            _('Approve'))) {
        return false;
    }
    await api.approve(request.id);
    return true;
}

function approve(api, request, zones, home) {
    const picked = zoneChoice(zones, home ? [home] : [], _('In which zones?'));
    return openDialog(
        _f('Approve {name}', { name: request.name }),
        (close) => form(
            [h('p', {}, _('All doors of these zones will know the person.')), picked.element], _('Approve'),
            () => api.approve(request.id, picked.read()), () => close(true), { cancel: () => close() }));
}

async function reject(api, request) {
    if (!await confirm(
            _f('Reject {name}?', { name: request.name }),
            _('The door removes the person, and the templates are erased.'),
            _f('Reject {name}', { name: request.name }), { danger: true })) {
        return false;
    }
    await api.reject(request.id);
    return true;
}

function make({ api, hub, may }) {
    const body = h('tbody', {});
    const fault = h('p', { class: 'fault', role: 'alert' });
    const none = h('p', { class: 'quiet', role: 'status' });
    let drawn = '';

    const doing = (work) => async () => {
        try {
            if (await work()) {
                notice(_('Saved.'));
            }
        } catch (error) {
            noticeFault(error);
        }
        hub.ask();
    };

    async function start(request) {
        const [zones, door] = await Promise.all([api.zones(), api.door(request.door.id)]);
        return may('administrator') ? approve(api, request, zones, door.zones[0]?.id) :
                                      approveAtHome(api, request, door.zones[0]);
    }

    function row(request) {
        const button = (text, work, kind) =>
            h('button', { type: 'button', class: kind, 'aria-label': `${text}: ${request.name}`, onclick: doing(work) },
              text);
        return h(
            'tr', {}, h('th', { scope: 'row' }, h('bdi', {}, request.name)),
            h('td', {}, h('bdi', {}, request.door.name)), h('td', {}, dateTime(request.time_s * 1000)),
            h('td', {},
              h('div', { class: 'buttons start' }, button(_('Approve…'), () => start(request), ''),
                button(_('Reject…'), () => reject(api, request), 'plain danger'))));
    }

    async function load() {
        try {
            const list = await api.requests();
            if (JSON.stringify(list) !== drawn) {
                drawn = JSON.stringify(list);
                fill(body, list.map(row));
            }
            fill(none, list.length ? '' : _('Nobody waits for approval.'));
            fill(fault);
        } catch (error) {
            fill(fault, faultText(error));
        }
    }

    const end = hub.on('tick', load);
    load();
    const head = (text) => h('th', { scope: 'col' }, text);
    return {
        element:
            h('div', {},
              h('p', { class: 'quiet' },
                _('Whoever is enrolled at a door of the fleet waits here, and becomes one of the fleet by approval.')),
              fault,
              h('div', { class: 'panel scroll', tabindex: 0, role: 'region', 'aria-label': _('Requests') },
                stack(h(
                    'table', {}, h('caption', { class: 'unseen' }, _('Requests')),
                    h('thead', {}, h('tr', {}, head(_('Name')), head(_('Door')), head(_('Time')), head(_('Decision')))),
                    body)),
                none)),
        resume: load,
        leave: end,
    };
}

export const requests = {
    id: 'requests',
    title: N_('Requests'),
    least: 'enroller',
    make
};
