/* The page Accounts: who may log in to these pages, and with which role. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {ROLES, ROLE_HELP, word} from '../base/words.js';
import {faultText} from '../transport/fault.js';
import {confirm, form, openDialog} from '../view/dialog.js';
import {choice, field, input, newPassword} from '../view/fields.js';
import {notice, noticeFault} from '../view/notice.js';
import {stack} from '../view/stack.js';

const roleChoice = (value) => choice(Object.keys(ROLES).map((role) => [role, word(ROLES, role)]), value);

function roleHelp(api) {
    return h(
        'ul', { class: 'help' },
        Object.keys(ROLES).map((role) => h('li', {}, h('strong', {}, word(ROLES, role)), ` ${word(api.roleHelp ?? ROLE_HELP, role)}`)));
}

function addAccount(api) {
    const name = input({
        required: true,
        maxlength: 32,
        pattern: '[a-z][a-z0-9._\\-]*',
        autocapitalize: 'none',
        spellcheck: 'false',
        dir: 'ltr'
    });
    const password = newPassword(_('Password'));
    const role = roleChoice('observer');
    return openDialog(
        _('Add an account'),
        (close) => form(
            [
                field(_('Name'), name, _('Small letters, digits, ".", "-" and "_"')), field(_('Role'), role),
                roleHelp(api), ...password.elements
            ],
            _('Add'), () => api.addAccount(name.value.trim(), password.read(), role.value), () => close(true),
            { cancel: () => close() }));
}

function setPassword(api, account) {
    const password = newPassword(_('New password'));
    return openDialog(
        _f('New password of {name}', { name: account.name }),
        (close) => form(
            password.elements, _('Save'), () => api.changeAccount(account.name, { password: password.read() }),
            () => close(true), { cancel: () => close() }));
}

function setRole(api, account) {
    const role = roleChoice(account.role);
    return openDialog(
        _f('Role of {name}', { name: account.name }),
        (close) => form(
            [field(_('Role'), role), roleHelp(api)], _('Save'),
            () => api.changeAccount(account.name, { role: role.value }), () => close(true), { cancel: () => close() }));
}

async function remove(api, account) {
    const sure = await confirm(
        _f('Remove {name}?', { name: account.name }), _('The account cannot log in any more, and its sessions end.'),
        _f('Remove {name}', { name: account.name }), { danger: true });
    if (sure) {
        await api.removeAccount(account.name);
    }
    return sure;
}

function make({ api, session }) {
    const body = h('tbody', {});
    const fault = h('p', { class: 'fault', role: 'alert' });

    const doing = (work) => async () => {
        try {
            if (await work()) {
                notice(_('Saved.'));
            }
        } catch (error) {
            noticeFault(error);
        }
        await load();
    };

    function row(account) {
        const own = account.name === session.account;
        const button = (text, work, kind = 'plain') =>
            h('button', { type: 'button', class: kind, 'aria-label': `${text}: ${account.name}`, onclick: doing(work) },
              text);
        return h(
            'tr', {},
            h('th', { scope: 'row' }, h('bdi', {}, account.name),
              own && h('span', { class: 'quiet' }, ` ${_('(you)')}`)),
            h('td', {}, word(ROLES, account.role)),
            h('td', {},
              h('div', { class: 'buttons start' }, button(_('Role…'), () => setRole(api, account)),
                button(_('Password…'), () => setPassword(api, account)),
                button(_('Remove…'), () => remove(api, account), 'plain danger'))));
    }

    async function load() {
        try {
            fill(body, (await api.accounts()).map(row));
            fill(fault);
        } catch (error) {
            fill(fault, faultText(error));
        }
    }

    load();
    const head = (text) => h('th', { scope: 'col' }, text);
    return {
        element:
            h('div', {}, fault,
              h('section', { class: 'panel' },
                h('div', { class: 'scroll' },
                  stack(
                      h('table', {}, h('caption', { class: 'unseen' }, _('Accounts')),
                        h('thead', {}, h('tr', {}, head(_('Name')), head(_('Role')), head(_('Changes')))), body))),
                h('div', { class: 'buttons start' },
                  h('button', { type: 'button', onclick: doing(() => addAccount(api)) }, _('Add an account…'))))),
        resume: load,
    };
}

export const accounts = {
    id: 'accounts',
    title: N_('Accounts'),
    least: 'administrator',
    needs: 'accounts',
    make
};
