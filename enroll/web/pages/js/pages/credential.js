/* The dialog of a person's cards, PIN, access profiles and suspension. No PIN is ever shown. */

import {_, _f} from '../base/i18n.js';
import {append, fill, h} from '../base/dom.js';
import {form, openDialog} from '../view/dialog.js';
import {checkbox, field, input} from '../view/fields.js';
import {faultText} from '../transport/fault.js';

const CARDS_MOST = 4;

/* Up to four cards. read() returns what is typed, without the empty ones. */
function cardList(cards) {
    const list = h('div', { class: 'cards' });
    const more = h('button', { type: 'button', class: 'plain' }, _('Add a card'));
    const update = () => {
        more.disabled = list.children.length >= CARDS_MOST;
        [...list.children].forEach((row, i) => {
            row.querySelector('input').setAttribute('aria-label', _f('Card {n}', { n: i + 1 }));
            row.querySelector('button').setAttribute('aria-label', _f('Remove card {n}', { n: i + 1 }));
        });
    };
    const add = (card, focus) => {
        const text = input({ value: card, maxlength: 40, dir: 'ltr', spellcheck: 'false' });
        const row =
            h('div', { class: 'row' }, text,
              h('button', {
                  type: 'button',
                  class: 'plain',
                  onclick: () => {
                      row.remove();
                      update();
                      more.focus();
                  }
              },
                '✕'));
        list.append(row);
        update();
        if (focus) {
            text.focus();
        }
    };
    cards.forEach((card) => add(card, false));
    more.addEventListener('click', () => add('', true));
    update();
    return {
        element:
            h('fieldset', {}, h('legend', {}, _('Cards')), list, more,
              h('p', { class: 'help' },
                _('Facility and number such as 17/4711, or number of bits and code such as 56:04a2b3c4d5e6f7.'))),
        read: () => [...list.querySelectorAll('input')].map((one) => one.value.trim()).filter(Boolean),
    };
}

/* One PIN. read() returns the new PIN, null if it is to be removed, undefined if it stays. */
function pinField(legend, isSet, help) {
    const secret = {
        type: 'password',
        inputmode: 'numeric',
        pattern: '[0-9]*',
        autocomplete: 'new-password',
        maxlength: 9
    };
    const first = input({...secret, title: _('Digits only') });
    const second = input({...secret, title: _('Digits only') });
    const remove = checkbox(_('Remove it'));
    return {
        element:
            h('fieldset', {}, h('legend', {}, legend),
              h('p', { class: 'help' }, isSet ? _('It is set.') : _('None is set.'), ' ', help),
              h('div', { class: 'pair' }, field(_('New PIN'), first), field(_('The same once more'), second)),
              isSet && remove.element),
        read() {
            if (first.value !== second.value) {
                throw new Error(_('The two PINs are different.'));
            }
            if (remove.box.checked) {
                return null;
            }
            return first.value === '' ? undefined : first.value;
        },
    };
}

/* The access profiles of the policy, and those of the person that the policy does not have any more. */
function profileList(document, own) {
    const known = (document?.access_profiles ?? []).map(({ token }) => token);
    const all = [...known, ...own.filter((token) => !known.includes(token))];
    const boxes = all.map((token) => [token, checkbox(h('bdi', {}, token), { checked: own.includes(token) })]);
    const standard = document?.default_profile;
    return {
        element:
            h('fieldset', {}, h('legend', {}, _('Access profiles')), boxes.map(([, { element }]) => element),
              h('p', { class: 'help' },
                !all.length  ? _('There is no policy with access profiles: the person may enter at any time.') :
                    standard ? _f('Without a tick the profile {profile} holds.', { profile: standard }) :
                               _('Without a tick the person may enter nowhere.'))),
        read: () => boxes.filter(([, { box }]) => box.checked).map(([token]) => token),
    };
}

const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/* The fields, and read() with the members of the merge patch that change. */
function fields(credential, document) {
    const cards = cardList(credential.cards);
    const pin = pinField(_('PIN'), credential.pin, _('4 to 9 digits.'));
    const duress = pinField(
        _('Duress PIN'), credential.duress_pin,
        _('Typed under threat, it opens the door as the PIN does. Nothing at the door shows it; the log does.'));
    const profiles = profileList(document, credential.profiles);
    const suspended = checkbox(_('Access is suspended'), { checked: !credential.enabled });
    const reason = input({ value: credential.disabled_reason, maxlength: 31, dir: 'auto' });
    const flags = [
        [
            'no_antipassback',
            checkbox(_('May enter again without having left'), { checked: credential.no_antipassback })
        ],
        ['needs_escort', checkbox(_('Needs somebody who comes along'), { checked: credential.needs_escort })],
    ];
    return {
        elements: [
            cards.element,
            pin.element,
            duress.element,
            profiles.element,
            h('fieldset', {}, h('legend', {}, _('Access')), suspended.element, field(_('Reason'), reason),
              flags.map(([, { element }]) => element)),
        ],
        read() {
            const wanted = {
                cards: cards.read(),
                profiles: profiles.read(),
                enabled: !suspended.box.checked,
                disabled_reason: suspended.box.checked ? reason.value.trim() : '',
                ...Object.fromEntries(flags.map(([name, { box }]) => [name, box.checked])),
            };
            const changed = Object.entries(wanted).filter(([name, value]) => !same(value, credential[name]));
            const pins =
                Object.entries({ pin: pin.read(), duress_pin: duress.read() }).filter(([,
                                                                                        value]) => value !== undefined);
            return Object.fromEntries([...changed, ...pins]);
        },
    };
}

/* Shows the credential of a person. Resolves to whether it was changed. */
export async function openCredential({api}, person) {
    const result = await openDialog(_f('Cards and access of {name}', { name: person.name }), (close) => {
        const place = h('div', {}, h('p', { class: 'quiet' }, _('Loading…')));
        Promise.all([api.credential(person.name), api.policy()])
            .then(([credential, { document }]) => {
                const { elements, read } = fields(credential, document);
                const send = async () => {
                    const patch = read();
                    if (Object.keys(patch).length) {
                        await api.changeCredential(person.name, patch);
                    }
                    return Object.keys(patch).length > 0;
                };
                fill(place, form(elements, _('Save'), send, (changed) => close(changed ? 'changed' : undefined), {
                         cancel: () => close()
                     }));
                place.querySelector('input, button')?.focus();
            })
            .catch((error) => {
                fill(place, h('p', { class: 'fault', role: 'alert' }, faultText(error)));
                append(
                    place,
                    h('div', { class: 'buttons' },
                      h('button', { type: 'button', onclick: () => close() }, _('Close'))));
            });
        return place;
    });
    return result === 'changed';
}
