/* Keeps a stream open: it is opened again after each end, at first soon, then more and more
 * seldom. */

const FIRST_MS = 500;
const MOST_MS = 15000;

/* The wait after so many failures in a row. `chance` (0..1) spreads clients that lost the server at
 * the same moment. */
export function backOffMs(failures, chance) {
    return Math.min(MOST_MS, FIRST_MS * 2 ** Math.min(failures, 10)) * (0.75 + 0.5 * chance);
}

function wait(ms, signal) {
    return new Promise((resolve) => {
        const timer = setTimeout(resolve, ms);
        signal.addEventListener('abort', () => {
            clearTimeout(timer);
            resolve();
        }, { once: true });
    });
}

/* Runs open(signal, alive) again and again. `open` returns a promise that ends with the stream, and
 * calls alive() whenever something arrived. onState(true) is called when something arrives after a
 * break, onState(false, fault) at each break. An answer of onState(false) that is "stop" ends it.
 * Returns {close()}. */
export function steady(open, onState) {
    const stop = new AbortController();
    (async () => {
        let failures = 0;
        while (!stop.signal.aborted) {
            let fault = null;
            let up = false;
            const alive = () => {
                failures = 0;
                if (!up && !stop.signal.aborted) {
                    up = true;
                    onState(true);
                }
            };
            try {
                await open(stop.signal, alive);
            } catch (error) {
                fault = error;
            }
            if (stop.signal.aborted || onState(false, fault) === 'stop') {
                return;
            }
            await wait(backOffMs(failures, Math.random()), stop.signal);
            failures += 1;
        }
    })();
    return { close: () => stop.abort() };
}
