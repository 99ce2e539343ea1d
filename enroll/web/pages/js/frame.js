/* The frame of the pages: navigation by the part of the address after "#", banner, account menu,
 * and the login. A page is a module with {id, title, least, make(context) -> {element, leave}}. The
 * pages of the door (app.js) and those of the hub of a fleet (enroll/hub/pages) have this frame. */

import {LANGUAGES, N_, _, _f, language, loadLanguage, storeLanguage} from './base/i18n.js';
import {fill, h} from './base/dom.js';
import {ROLES, word} from './base/words.js';
import {choice} from './view/fields.js';
import {notice, noticeFault, noticePlace} from './view/notice.js';
import {openDialog} from './view/dialog.js';
import {faultText} from './transport/fault.js';
import {loginForm} from './pages/login.js';
import {changePassword} from './pages/password.js';
const RANKS = ['observer', 'enroller', 'administrator'];
const PRODUCT = N_('Isotherm');

/* `all` are the pages, of which the first is the home. makeState(api) returns what all pages know:
 * {start, stop, on(name, listener)}. banner(context) returns the element above the pages. */
export function makeFrame(api, root, {all, makeState, banner}) {
    let context = null;
    let page = null;
    let loggingIn = false;

    const may = (session, least) => RANKS.indexOf(session.role) >= RANKS.indexOf(least);
    const pages = () => all.filter((one) => may(context.session, one.least) && (!one.needs || api.can[one.needs]));

    function route() {
        const [id, query = ''] = location.hash.slice(1).split('?');
        return { id, query: new URLSearchParams(query) };
    }

    function show(focus) {
        const { id, query } = route();
        const next = pages().find((one) => one.id === id) ?? pages()[0];
        page?.leave?.();
        page = next.make({...context, query });
        document.title = `${_(next.title)} – ${_(PRODUCT)}`;
        for (const link of root.querySelectorAll('nav a')) {
            const here = link.hash === `#${next.id}`;
            link.toggleAttribute('aria-current', here);
            if (here) {
                link.setAttribute('aria-current', 'page');
                link.scrollIntoView({ block: 'nearest', inline: 'nearest' });
            }
        }
        const heading = h('h1', { tabindex: -1 }, _(next.title));
        fill(root.querySelector('main'), heading, page.element);
        if (focus) {
            heading.focus({ preventScroll: true });
            scrollTo(0, 0);
        }
    }

    async function logout() {
        try {
            await api.logout();
        } catch (error) {
            if (error.code !== 'login-required') {
                noticeFault(error);
                return;
            }
        }
        close();
        login();
    }

    function languageChoice() {
        return choice(Object.entries(LANGUAGES), language(), {
            'aria-label': _('Language'),
            class: 'language',
            onchange: async (event) => {
                storeLanguage(event.target.value);
                await loadLanguage(event.target.value);
                redraw();
            },
        });
    }

    function accountMenu() {
        const { session } = context;
        if (!api.can.login) {
            return h(
                'p', { class: 'account' },
                _f('{account}, {role}', { account: session.account, role: word(ROLES, session.role) }));
        }
        const menu = h(
            'details', { class: 'account' }, h('summary', {}, session.account),
            h('div', { class: 'menu' }, h('p', { class: 'quiet' }, word(ROLES, session.role)),
              h('button', { type: 'button', class: 'plain', onclick: () => changePassword(api) }, _('Change password')),
              h('button', { type: 'button', class: 'plain', onclick: logout }, _('Log out'))));
        menu.addEventListener('keydown', (event) => {
            if (event.key === 'Escape') {
                menu.open = false;
                menu.querySelector('summary').focus();
            }
        });
        menu.addEventListener('focusout', (event) => {
            if (!menu.contains(event.relatedTarget)) {
                menu.open = false;
            }
        });
        return menu;
    }

    function frame() {
        fill(
            root,
            h('button', { type: 'button', class: 'skip', onclick: () => root.querySelector('h1').focus() },
              _('Skip to the content')),
            h('header', { class: 'top' },
              h('a', { class: 'brand', href: `#${all[0].id}` },
                h('img', { src: 'icon.svg', alt: '', width: 28, height: 28 }), _(PRODUCT)),
              h('nav', { 'aria-label': _('Pages') },
                h('ul', {}, pages().map((one) => h('li', {}, h('a', { href: `#${one.id}` }, _(one.title)))))),
              h('div', { class: 'tools' }, languageChoice(), accountMenu())),
            banner(context), h('main', {}), noticePlace());
    }

    function redraw() {
        if (context) {
            frame();
            show(false);
        } else {
            login();
        }
    }

    function open(session) {
        const hub = makeState(api);
        context = { api, hub, session, may: (least) => may(session, least) };
        hub.start();
        frame();
        show(true);
    }

    function close() {
        page?.leave?.();
        page = null;
        context?.hub.stop();
        context = null;
    }

    /* The login as the whole page. */
    function login(setup = false) {
        document.title = `${_('Log in')} – ${_(PRODUCT)}`;
        fill(
            root,
            h('main', { class: 'login' },
              h('div', { class: 'brand' }, h('img', { src: 'icon.svg', alt: '', width: 48, height: 48 }),
                h('h1', {}, _(PRODUCT))),
              loginForm(api, setup, open), languageChoice()),
            noticePlace());
        root.querySelector('input')?.focus();
    }

    /* The session has ended. The page stays under the dialog, with all that was typed into it. */
    async function loginAgain() {
        if (loggingIn || !context) {
            return;
        }
        loggingIn = true;
        const { session } = context;
        context.hub.stop();
        const fresh = await openDialog(
            _('Please log in again'),
            (done) =>
                [h('p', {}, _('Your session has ended. What you typed is still there.')),
                 loginForm(api, false, done, session.account)],
            { firm: true });
        loggingIn = false;
        if (!fresh || fresh.account !== session.account || fresh.role !== session.role) {
            close();
            fresh ? open(fresh) : login();
            return;
        }
        context.hub.start();
        page?.resume?.();
        notice(_('You are logged in again.'));
    }

    return async function start() {
        api.onLoginRequired(loginAgain);
        addEventListener('hashchange', () => context && show(true));
        for (let wait = 1000;; wait = Math.min(15000, wait * 2)) {
            try {
                open(await api.session());
                return;
            } catch (fault) {
                if (fault.code === 'login-required' && api.can.login) {
                    login(fault.setup);
                    return;
                }
                fill(
                    root,
                    h('main', { class: 'login' }, h('h1', {}, _(PRODUCT)), h('p', { role: 'alert' }, faultText(fault)),
                      h('p', { class: 'quiet' }, _('Trying again…'))));
            }
            await new Promise((resolve) => {
                setTimeout(resolve, wait);
            });
        }
    };
}
