/* The dialog of one person: what is known, and for administrators rename, limits and remove. */

import {_, _f} from '../base/i18n.js';
import {h} from '../base/dom.js';
import {dateTime, limit} from '../base/format.js';
import {badge} from '../view/badge.js';
import {checkbox, field, input, limits} from '../view/fields.js';
import {confirm, form, openDialog} from '../view/dialog.js';
import {notice, noticeFault} from '../view/notice.js';
import {openCredential} from './credential.js';

function facts(person, withLimits) {
    const row = (name, value) => [h('dt', {}, name), h('dd', {}, value)];
    return h(
        'dl', { class: 'facts' },
        withLimits &&
            [row(_('Valid from'), limit(person.valid_from_s)), row(_('Valid until'), limit(person.valid_until_s))],
        row(_('Templates'), person.templates), row(_('Enrolled'), dateTime(person.enrolled_s * 1000)),
        row(_('Last seen'), person.last_seen_s ? dateTime(person.last_seen_s * 1000) : '–'),
        person.cards && row(_('Cards'), h('bdi', {}, person.cards.join(' ') || '–')),
        person.enabled === false && row(_('Access'), badge('bad', _('suspended'))));
}

function editor({ api }, person, close) {
    const name = input({ value: person.name, required: true, maxlength: 64, dir: 'auto' });
    const times = limits(person.valid_from_s, person.valid_until_s);
    const expired = checkbox(_('The end may be in the past'));
    const send = async () => {
        const change = {};
        const { valid_from_s, valid_until_s } = times.read();
        if (name.value !== person.name) {
            change.name = name.value.trim();
        }
        if (valid_from_s !== person.valid_from_s || valid_until_s !== person.valid_until_s) {
            Object.assign(change, { valid_from_s, valid_until_s });
            if (valid_until_s && valid_until_s * 1000 <= Date.now()) {
                if (!expired.box.checked) {
                    throw new Error(_('The end is in the past. Tick the box if this is right.'));
                }
                change.expired = true;
            }
        }
        if (Object.keys(change).length) {
            const { remark } = (await api.changePerson(person.name, change)) ?? {};
            if (remark) {
                notice(remark);
            }
        }
    };
    return [
        form(
            [field(_('Name'), name), times.element, expired.element], _('Save'), send, () => close('saved'),
            { cancel: () => close() }),
        h('div', { class: 'buttons start' },
          h('a',
            { class: 'button plain', href: `#enrol?name=${encodeURIComponent(person.name)}`, onclick: () => close() },
            _('Enrol again')),
          h('button', { type: 'button', class: 'plain', onclick: () => close('credential') }, _('Cards and access…')),
          h('button', { type: 'button', class: 'danger', onclick: () => close('remove') }, _('Remove…'))),
    ];
}

async function remove({ api }, person) {
    const sure = await confirm(
        _f('Remove {name}?', { name: person.name }),
        _f('All templates of {name} are erased. The door will not open to this person any more. This cannot be undone.',
           { name: person.name }),
        _f('Remove {name}', { name: person.name }), { danger: true });
    if (sure) {
        await api.removePerson(person.name);
        notice(_f('{name} is removed.', { name: person.name }));
    }
    return sure;
}

/* Shows a person; changed() is called after a change. */
export async function openPerson(context, person, changed) {
    const admin = context.may('administrator');
    const result = await openDialog(
        person.name,
        (close) =>
            [facts(person, !admin),
             admin ?
                 editor(context, person, close) :
                 h('div', { class: 'buttons' }, h('button', { type: 'button', onclick: () => close() }, _('Close')))]);
    try {
        if (result === 'saved') {
            notice(_('Saved.'));
            changed();
        } else if (result === 'credential' && await openCredential(context, person)) {
            notice(_('Saved.'));
            changed();
        } else if (result === 'remove' && await remove(context, person)) {
            changed();
        }
    } catch (error) {
        noticeFault(error);
        changed();
    }
}
