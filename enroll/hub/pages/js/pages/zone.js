/* The dialogs of one zone: a new one, what holds in it, its key, and its recovery. */

import {_, _f} from '../base/i18n.js';
import {h} from '../base/dom.js';
import {duration, number} from '../base/format.js';
import {confirm, form, openDialog} from '../view/dialog.js';
import {checkbox, choice, field, input} from '../view/fields.js';
import {notice, noticeFault} from '../view/notice.js';

const LEASES = [0, 3600, 8 * 3600, 24 * 3600, 3 * 24 * 3600, 7 * 24 * 3600, 30 * 24 * 3600];

/* How long a door acts on its own. */
export function leaseText(seconds) { return seconds ? duration(seconds * 1000) : _('not at all'); }

export async function addZone({api}, changed) {
    const name = input({ required: true, maxlength: 64, dir: 'auto' });
    const done = await openDialog(
        _('Add a zone'),
        (close) => form(
            [h('p', {}, _('A zone is a group of doors with the same people.')), field(_('Name'), name)], _('Add'),
            () => api.addZone(name.value.trim()), () => close(true), { cancel: () => close() }));
    if (done) {
        notice(_('Saved.'));
        changed();
    }
}

function facts(zone) {
    const row = (name, value) => [h('dt', {}, name), h('dd', {}, value)];
    return h(
        'dl', { class: 'facts' }, row(_('Doors'), number(zone.doors)), row(_('People'), number(zone.people)),
        row(_('Changes so far'), number(zone.sequence)), row(_('Key number'), number(zone.epoch)),
        row(_('Without the hub'), leaseText(zone.lease_s)));
}

function editor({ api }, zone, close) {
    const options = [...new Set([...LEASES, zone.lease_s])].sort((a, b) => a - b);
    const lease = choice(options.map((s) => [String(s), leaseText(s)]), String(zone.lease_s));
    const local = checkbox(
        _('People who were enrolled at a door may enter there before they are approved'),
        { checked: zone.local_people });
    const auto = checkbox(_('People who were enrolled at a door are approved at once'), { checked: zone.approve_auto });
    return [
        form(
            [
                field(
                    _('How long a door acts without the hub'), lease,
                    _('After this time only people who may enter offline are admitted.')),
                local.element, auto.element
            ],
            _('Save'),
            () => api.changeZone(
                zone.id,
                { lease_s: Number(lease.value), local_people: local.box.checked, approve_auto: auto.box.checked }),
            () => close('saved'), { cancel: () => close() }),
        h('div', { class: 'buttons start' },
          h('button', { type: 'button', class: 'plain', onclick: () => close('renew') }, _('New key…')),
          zone.behind &&
              h('button', { type: 'button', class: 'danger', onclick: () => close('recover') }, _('Recover…'))),
    ];
}

async function renew({ api }, zone) {
    if (await confirm(
            _f('New key for {name}?', { name: zone.name }),
            _('The doors of the zone get it at once. Whoever has the old key can read nothing more.'), _('New key'))) {
        await api.renewZone(zone.id);
        return true;
    }
    return false;
}

async function recover({ api }, zone) {
    if (await confirm(
            _f('Recover {name}?', { name: zone.name }),
            _('The doors take over what this database knows. People who were added after the copy was made are lost at the doors, and revocations after it have to be made again.'),
            _('Recover'), { danger: true })) {
        await api.recoverZone(zone.id);
        return true;
    }
    return false;
}

/* Shows a zone; changed() is called after a change. */
export async function openZone(context, zone, changed) {
    const admin = context.may('administrator');
    const result = await openDialog(
        zone.name,
        (close) =>
            [facts(zone),
             admin ?
                 editor(context, zone, close) :
                 h('div', { class: 'buttons' }, h('button', { type: 'button', onclick: () => close() }, _('Close')))]);
    const acts = { renew, recover, saved: () => true };
    try {
        if (acts[result] && await acts[result](context, zone)) {
            notice(_('Saved.'));
        }
    } catch (error) {
        noticeFault(error);
    }
    changed();
}
