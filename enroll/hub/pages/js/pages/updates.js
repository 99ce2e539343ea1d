/* The page Updates: which versions of the doors' image the hub keeps, how far the zones are with
 * them, and in a dialog each door of a zone. Administrators stop rollouts here and let them go on; versions are added and rolled out by
 * the command isotherm-hub update. */

import {N_, _, _f} from '../base/i18n.js';
import {DOOR_UPDATES, ROLLOUTS} from '../base/fleet_words.js';
import {fill, h} from '../base/dom.js';
import {dateTime, number} from '../base/format.js';
import {faultText} from '../transport/fault.js';
import {badge} from '../view/badge.js';
import {confirm, openDialog} from '../view/dialog.js';
import {notice, noticeFault} from '../view/notice.js';
import {stack} from '../view/stack.js';

const MIB = 1 << 20;

const ROLLOUT_KINDS = {
    running: 'plain',
    stopped: 'bad',
    done: 'good',
    replaced: 'plain'
};

const DOOR_KINDS = {
    failed: 'bad',
    'went-back': 'bad',
    healthy: 'good',
    unable: 'odd'
};

/* Sentences of the hub and of doors are English. */
const english = (text) => text && h('span', { class: 'quiet', lang: 'en', dir: 'ltr' }, ` ${text}`);

function table(name, heads, body) {
    return stack(
        h('table', {}, h('caption', { class: 'unseen' }, name),
          h('thead', {}, h('tr', {}, heads.map((text) => h('th', { scope: 'col' }, text)))), body));
}

function fileRow(file) {
    return h(
        'tr', {}, h('th', { scope: 'row' }, h('bdi', {}, file.version)), h('td', {}, h('bdi', {}, file.board)),
        h('td', {}, `${number(file.bytes / MIB, 1)} MiB`), h('td', {}, dateTime(file.added_s * 1000)));
}

/* How many doors are how far; what is none is not said. */
function progress(rollout) {
    const some = (kind, text, n) => n > 0 && badge(kind, _f(text, { n: number(n) }));
    return h(
        'span', { class: 'badges' },
        badge('plain', _f('{n} of {all} run it', { n: number(rollout.healthy), all: number(rollout.doors) })),
        some('bad', N_('Failed: {n}'), rollout.failed), some('plain', N_('At work: {n}'), rollout.at_work),
        some('plain', N_('Not told yet: {n}'), rollout.waiting), some('odd', N_('Take no part: {n}'), rollout.unable));
}

function doorRow(door) {
    return h(
        'tr', {}, h('th', { scope: 'row' }, h('bdi', {}, door.name)),
        h('td', {}, badge(DOOR_KINDS[door.state] ?? 'plain', _(DOOR_UPDATES[door.state])), english(door.fault)),
        h('td', {}, dateTime(door.changed_s * 1000)));
}

/* The doors of the newest rollout of a zone. */
async function openDoors({ api }, zone) {
    let doors;
    try {
        doors = await api.rollout(zone);
    } catch (error) {
        noticeFault(error);
        return;
    }
    await openDialog(
        zone,
        (close) =>
            [h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': _('Doors') },
               table(_('Doors'), [_('Door'), _('State'), _('Since')], h('tbody', {}, doors.map(doorRow)))),
             h('div', { class: 'buttons' },
               h('button', { type: 'button', class: 'plain', autofocus: true, onclick: () => close() }, _('Close')))],
        { wide: true });
}

/* Stops a rollout, or lets a stopped one go on. */
async function turn({ api, changed }, { id, zone, version }, running) {
    const name = { name: zone, version };
    const agreed = running ?
        confirm(
            _f('Let the rollout of {version} in {name} go on?', name),
            _('Doors that have failed so far do not count any more, and are not told again.'), _('Let it go on')) :
        confirm(
            _f('Stop the rollout of {version} in {name}?', name),
            _('No further door is told. Doors that install it just now finish that, and do not restart.'), _('Stop it'),
            { danger: true });
    try {
        if (await agreed) {
            await api.turnRollout(zone, id, running);
            notice(running ? _('The rollout goes on.') : _('The rollout is stopped.'));
        }
    } catch (error) {
        noticeFault(error);
    }
    changed();
}

function turnButton(context, rollout) {
    const running = rollout.state === 'stopped';
    if (!running && rollout.state !== 'running') {
        return null;
    }
    const text = running ? _('Let it go on…') : _('Stop…');
    return h(
        'button', {
            type: 'button',
            class: running ? '' : 'plain danger',
            'aria-label': [text, rollout.zone].join(' '),
            onclick: () => turn(context, rollout, running)
        },
        text);
}

/* Only the newest rollout of a zone has doors to show. */
function rolloutRow(context, rollout, isNewest) {
    const name = h('bdi', {}, rollout.zone);
    return h(
        'tr', {},
        h('th', { scope: 'row' },
          isNewest ?
              h('button', { type: 'button', class: 'link', onclick: () => openDoors(context, rollout.zone) }, name) :
              name),
        h('td', {}, h('bdi', {}, rollout.version)),
        h('td', {}, badge(ROLLOUT_KINDS[rollout.state], _(ROLLOUTS[rollout.state])), english(rollout.why)),
        h('td', {}, progress(rollout)), h('td', {}, dateTime(rollout.started_s * 1000)),
        context.admin && h('td', {}, turnButton(context, rollout)));
}

function make(context) {
    const { api, hub, may } = context;
    const admin = may('administrator');
    const acts = { api, admin, changed: () => load() };
    const fault = h('p', { class: 'fault', role: 'alert' });
    const files = h('tbody', {}), rollouts = h('tbody', {});
    const noFiles = h('p', { class: 'quiet', role: 'status' }), noRollouts = h('p', { class: 'quiet', role: 'status' });
    let drawn = '';

    function draw(all) {
        const seen = new Set();
        const newestFirst = [...all.rollouts].reverse();
        fill(files, all.files.map(fileRow));
        fill(rollouts, newestFirst.map((one) => {
            const isNewest = !seen.has(one.zone);
            seen.add(one.zone);
            return rolloutRow(acts, one, isNewest);
        }));
        fill(noFiles, all.files.length ? '' : _('The hub keeps no update.'));
        fill(noRollouts, all.rollouts.length ? '' : _('No update was rolled out yet.'));
    }

    async function load() {
        try {
            const all = await api.updates();
            if (JSON.stringify(all) !== drawn) {
                drawn = JSON.stringify(all);
                draw(all);
            }
            fill(fault);
        } catch (error) {
            fill(fault, faultText(error));
        }
    }

    const end = hub.on('tick', load);
    load();
    const panel = (title, ...parts) =>
        h('section', { class: 'panel' }, h('h2', {}, title),
          h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': title }, parts));
    return {
        element: h(
            'div', {},
            h('p', { class: 'quiet' },
              _('Doors that run an image of the appliance get new versions zone by zone, in stages. Updates are added and rolled out with isotherm-hub update.')),
            fault,
            panel(
                _('Rollouts'),
                table(
                    _('Rollouts'),
                    [_('Zone'), _('Version'), _('State'), _('Doors'), _('Since'), ...(admin ? [_('Change')] : [])],
                    rollouts),
                noRollouts),
            panel(_('Files'), table(_('Files'), [_('Version'), _('Board'), _('Size'), _('Added')], files), noFiles)),
        resume: load,
        leave: end,
    };
}

export const updates = {
    id: 'updates',
    title: N_('Updates'),
    least: 'observer',
    make
};
