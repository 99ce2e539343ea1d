/* The dialog of one person of the fleet: name, limits, zones, and the revocation. */

import {_, _f} from '../base/i18n.js';
import {h} from '../base/dom.js';
import {dateTime, limit} from '../base/format.js';
import {confirm, form, openDialog} from '../view/dialog.js';
import {checkbox, field, input, limits} from '../view/fields.js';
import {notice, noticeFault} from '../view/notice.js';
import {showWaiting} from '../view/waiting.js';
import {zoneChoice} from '../view/zone_choice.js';

function facts(person, all) {
    const row = (name, value) => [h('dt', {}, name), h('dd', {}, value)];
    return h(
        'dl', { class: 'facts' }, row(_('Templates'), person.templates),
        row(_('Enrolled'), person.enrolled_s ? dateTime(person.enrolled_s * 1000) : '–'), all && [
            row(_('Zones'), h('bdi', {}, person.zones.map(({ name }) => name).join(', '))),
            row(_('Valid from'), limit(person.valid_from_s)), row(_('Valid until'), limit(person.valid_until_s)),
            row(_('Also offline'), person.offline_ok ? _('yes') : _('no'))
        ]);
}

function editor({ api }, person, zones, close) {
    const name = input({ value: person.name, required: true, maxlength: 64, dir: 'auto' });
    const times = limits(person.valid_from_s, person.valid_until_s);
    const offline = checkbox(
        _('May enter also at a door that has not heard of the hub for too long'), { checked: person.offline_ok });
    const before = person.zones.map(({ id }) => id);
    const picked = zoneChoice(zones, before);
    const send = async () => {
        const change = {};
        const { valid_from_s, valid_until_s } = times.read();
        const chosen = picked.read();
        if (name.value !== person.name) {
            change.name = name.value.trim();
        }
        if (valid_from_s !== person.valid_from_s || valid_until_s !== person.valid_until_s) {
            Object.assign(change, { valid_from_s, valid_until_s });
        }
        if (offline.box.checked !== person.offline_ok) {
            change.offline_ok = offline.box.checked;
        }
        if (chosen.length !== before.length || chosen.some((id) => !before.includes(id))) {
            change.zones = chosen;
        }
        if (Object.keys(change).length) {
            await api.changePerson(person.id, change);
        }
    };
    return [
        form(
            [field(_('Name'), name), times.element, offline.element, picked.element], _('Save'), send,
            () => close('saved'), { cancel: () => close() }),
        h('div', { class: 'buttons start' },
          h('button', { type: 'button', class: 'danger', onclick: () => close('revoke') }, _('Revoke now…'))),
    ];
}

async function revoke({ api }, person) {
    if (!await confirm(
            _f('Revoke {name}?', { name: person.name }),
            _f('No door admits {name} any more, and all templates of {name} are erased. This cannot be undone.',
               { name: person.name }),
            _f('Revoke {name}', { name: person.name }), { danger: true })) {
        return false;
    }
    const { zones } = await api.revokePerson(person.id);
    await showWaiting(
        api, _f('{name} is revoked.', { name: person.name }),
        _('A door that has not confirmed may still admit the person until its time without the hub is over.'), zones);
    return true;
}

/* Shows a person; changed() is called after a change. */
export async function openFleetPerson(context, person, zones, changed) {
    const admin = context.may('administrator');
    const result = await openDialog(
        person.name,
        (close) =>
            [facts(person, !admin),
             admin ?
                 editor(context, person, zones, close) :
                 h('div', { class: 'buttons' }, h('button', { type: 'button', onclick: () => close() }, _('Close')))]);
    try {
        if (result === 'saved') {
            notice(_('Saved.'));
            changed();
        } else if (result === 'revoke' && await revoke(context, person)) {
            changed();
        }
    } catch (error) {
        noticeFault(error);
        changed();
    }
}
