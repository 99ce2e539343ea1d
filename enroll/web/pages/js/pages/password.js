/* The dialog with which a user changes the own password. */

import {_} from '../base/i18n.js';
import {openDialog, form} from '../view/dialog.js';
import {field, input, newPassword} from '../view/fields.js';
import {notice} from '../view/notice.js';

export async function changePassword(api) {
    const old = input({ type: 'password', autocomplete: 'current-password', required: true });
    const fresh = newPassword(_('New password'));
    const changed = await openDialog(
        _('Change password'),
        (close) => form(
            [field(_('Present password'), old), ...fresh.elements], _('Change password'),
            () => api.changePassword(old.value, fresh.read()), () => close(true), { cancel: () => close() }));
    if (changed) {
        notice(_('The password is changed. Your other sessions have ended.'));
    }
}
