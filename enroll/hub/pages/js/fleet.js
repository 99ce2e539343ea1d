/* What all pages know of the fleet: its numbers, asked again every few seconds while the page is
 * seen. Events for listeners: "connection" (true or false), "changed" (the numbers, or the connection),
 * "tick" (asked again; for pages that show more than numbers). */

import { makeListeners } from './base/listeners.js';

const EVERY_MS = 5000;

export function makeFleet(api) {
    let timer = 0;
    let running = false;
    const fleet = {
        connected: null, /* null: not known yet */
        status: null,

        ...makeListeners(),

        start() {
            running = true;
            document.addEventListener('visibilitychange', follow);
            follow();
        },

        stop() {
            running = false;
            clearTimeout(timer);
            document.removeEventListener('visibilitychange', follow);
        },

        /* Asks now, after a change. */
        async ask() {
            clearTimeout(timer);
            let up = true;
            try {
                fleet.status = await api.status();
            } catch (fault) {
                up = fault.status > 0 && fault.code !== 'no-database' ? fleet.connected : false;
            }
            if (!running) {
                return;
            }
            if (up !== fleet.connected) {
                fleet.connected = up;
                fleet.tell('connection', up);
            }
            fleet.tell('changed');
            if (up) {
                fleet.tell('tick');
            }
            clearTimeout(timer);
            timer = setTimeout(follow, EVERY_MS);
        },
    };

    /* A hidden page does not ask. */
    function follow() {
        clearTimeout(timer);
        if (running && !document.hidden) {
            fleet.ask();
        }
    }
    return fleet;
}
