/* What happens at the door, for all pages: one stream of events of the API, given to those who
 * listen. It remembers the last status, visits and enrolment. */

import { makeListeners } from './base/listeners.js';

const VISITS_MOST = 50;

/* Events besides those of the API: "connection" (true or false) and "changed" (something that the
 * banner shows). */
export function makeHub(api) {
    let stream = null;
    const hub = {
        connected: null, /* null: not known yet */
        daemon: null,
        status: {},
        visits: [], /* the newest first */
        enrolment: null,

        ...makeListeners(),

        start() {
            document.addEventListener('visibilitychange', follow);
            follow();
        },

        stop() {
            document.removeEventListener('visibilitychange', follow);
            stream?.close();
            stream = null;
        },
    };

    /* A browser allows six connections to a server, for all its tabs together: a hidden tab gives
     * its own back. An enrolment goes on only while its tab listens. */
    function follow() {
        if (document.hidden && !(hub.enrolment?.own && hub.enrolment.state === 'running')) {
            stream?.close();
            stream = null;
        } else {
            stream ??= api.events(receive, connection);
        }
    }

    function connection(up) {
        if (hub.connected !== up) {
            hub.connected = up;
            hub.tell('connection', up);
            hub.tell('changed');
        }
    }

    function receive(name, value) {
        if (name === 'status') {
            hub.status = value?.status ?? {};
            hub.daemon = value?.daemon === true;
        } else if (name === 'visit') {
            hub.visits = [value, ...hub.visits].slice(0, VISITS_MOST);
        } else if (name === 'door') {
            hub.status = {...hub.status, 'door-state': value?.state };
        } else if (name === 'enrolment') {
            /* Events do not say whose enrolment it is; the page asked for that before. */
            const own = hub.enrolment?.own && hub.enrolment.person === value?.person;
            hub.enrolment = {...value, own: value?.own ?? own ?? false };
        }
        hub.tell(name, name === 'enrolment' ? hub.enrolment : value);
        hub.tell('changed');
    }
    return hub;
}
