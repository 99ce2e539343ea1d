/* The page Enrol: the form with the privacy note, then the guided enrolment, then its result. */

import {N_, _} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {faultText} from '../transport/fault.js';
import {form} from '../view/dialog.js';
import {checkbox, field, input, limits} from '../view/fields.js';
import {enrolLive} from './enrol_live.js';
import {enrolResult} from './enrol_result.js';

function privacyNote() {
    return h(
        'section', { class: 'note', 'aria-labelledby': 'privacy' },
        h('h3', { id: 'privacy' }, _('Before you begin: privacy')),
        h('ul', {},
          h('li', {}, _('What is measured: the shape of the face, by a depth camera. No photograph is taken.')),
          h('li', {},
            _('What is stored: the name, the limits, and templates: curves and heights of the face. They are sealed on this appliance. They are no picture, but the person can be recognised by them.')),
          h('li', {},
            _('What for: only to open this door to the person, and other doors to which an administrator transfers the enrolment.')),
          h('li', {},
            _('What else is recorded: each visit, with time, name and verdict, in the log of the appliance.')),
          h('li', {},
            _('How it ends: an administrator removes the person on the page People. The templates are then erased at once. Records in the log stay.'))));
}

function wishForm({ api, query }, begun) {
    const name = input({ required: true, maxlength: 64, dir: 'auto', value: query.get('name') ?? '' });
    const times = limits();
    const poses = checkbox(
        _('Also turned to the sides, chin down and chin up (recommended: the door then recognises the person from more directions)'),
        { checked: true });
    const duplicate = checkbox(_('Enrol the face even if it is enrolled under another name'));
    const consent = checkbox(_('The person has read this note and consents.'), { required: true });
    return form(
        [
            field(_('Name'), name, _('If the name is enrolled already, the person gets further templates.')),
            times.element, poses.element, h('details', {}, h('summary', {}, _('More')), duplicate.element),
            privacyNote(), consent.element
        ],
        _('Begin'), async () => {
            const { valid_from_s, valid_until_s } = times.read();
            const wish = { person: name.value.trim(), consent: consent.box.checked, poses: poses.box.checked };
            /* A limit that is left empty stays as it is for a person who is enrolled. */
            return api.beginEnrolment({
                ...wish,
                ...(duplicate.box.checked && { allow_duplicate: true }),
                ...(valid_from_s && { valid_from_s }),
                ...(valid_until_s && { valid_until_s })
            });
        }, begun);
}

function make(context) {
    const { api, hub } = context;
    const place = h('div', {});
    let present = null;
    let gone = false;

    function show(part) {
        present?.leave?.();
        present = part;
        fill(place, part.element);
    }

    function ask(query = context.query) {
        show({
            element:
                h('div', { class: 'panel' }, h('h2', {}, _('Who is to be enrolled?')),
                  wishForm({...context, query }, begun))
        });
    }

    function begun(enrolment) {
        hub.enrolment = { state: 'running', ...enrolment, own: true };
        watch();
    }

    function watch() { show(enrolLive(context, ended)); }

    function ended(enrolment) {
        show({
            element: enrolResult(
                enrolment, () => ask(new URLSearchParams()),
                () => ask(new URLSearchParams({ name: enrolment.person ?? '' })))
        });
        place.querySelector('h2')?.focus();
    }

    function other(enrolment) {
        const end = hub.on('enrolment', (now) => now.state !== 'running' && ask());
        show({
            leave: end,
            element:
                h('div', { class: 'panel' }, h('p', {}, _('Another enrolment goes on.')),
                  enrolment.account && h('p', { class: 'quiet' }, enrolment.account))
        });
    }

    (async () => {
        try {
            const enrolment = await api.enrolment();
            if (gone) {
                return;
            }
            hub.enrolment = enrolment;
            if (enrolment.state !== 'running') {
                ask();
            } else if (enrolment.own) {
                watch();
            } else {
                other(enrolment);
            }
        } catch (error) {
            fill(place, h('p', { class: 'fault', role: 'alert' }, faultText(error)));
        }
    })();
    return {
        element: place,
        resume: () => present?.resume?.(),
        leave() {
            gone = true;
            present?.leave?.();
        },
    };
}

export const enrol = {
    id: 'enrol',
    title: N_('Enrol'),
    least: 'enroller',
    make
};
