/* The login, and the first set-up with a one-time code. */

import {_} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {form} from '../view/dialog.js';
import {field, input, newPassword} from '../view/fields.js';

const accountInput = (value) => input({
    name: 'account',
    autocomplete: 'username',
    required: true,
    value,
    autocapitalize: 'none',
    spellcheck: 'false',
    maxlength: 32,
    dir: 'ltr'
});

function login(api, done, account) {
    const name = accountInput(account);
    const password = input({ type: 'password', name: 'password', autocomplete: 'current-password', required: true });
    return form(
        [field(_('Account'), name), field(_('Password'), password)], _('Log in'),
        () => api.login(name.value.trim(), password.value), done);
}

function setup(api, done) {
    const code =
        input({ required: true, dir: 'ltr', autocapitalize: 'characters', spellcheck: 'false', maxlength: 40 });
    const name = accountInput('');
    name.pattern = '[a-z][a-z0-9._\\-]*';
    const password = newPassword(_('Password'));
    return form(
        [
            field(
                _('One-time code'), code,
                api.setupHelp?.() ??
                    _('On an image of the appliance the screen at the door shows it, on other machines the command "sudo isotherm web setup".')),
            field(_('Account'), name, _('Small letters, digits, ".", "-" and "_"')), ...password.elements
        ],
        _('Make the account'), () => api.setup(code.value, name.value.trim(), password.read()), done);
}

/* The form for the login, with a way to the set-up and back. `first`: there is no account yet.
 * done(session) is called after the login. */
export function loginForm(api, first, done, account = '') {
    const place = h('div', { class: 'panel' });
    const show = (asSetup) => {
        fill(
            place, !account && h('h2', {}, asSetup ? _('Set up the first account') : _('Log in')),
            asSetup && first && h('p', {}, _('There is no account yet. The first one is that of an administrator.')),
            asSetup ? setup(api, done) : login(api, done, account),
            !account &&
                h('button', {
                    type: 'button',
                    class: 'link',
                    onclick: () => {
                        show(!asSetup);
                        place.querySelector('input').focus();
                    }
                },
                  asSetup ? _('I have an account') : _('I have a one-time code')));
    };
    show(first);
    return place;
}
