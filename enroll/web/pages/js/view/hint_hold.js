/* Keeps a hint long enough for people to read it. Words of the camera may change with each frame. */

export const SHOWN_MS = 1200;

/* Returns a function that takes the newest text. show(text) is called at once if the last text was
 * shown long enough, else later, with the newest text of that moment. With `atOnce` it does not wait:
 * the text before has become wrong. The clock and the timer can be given, for tests. */
export function holdHint(show, {now = () => performance.now(), later = setTimeout} = {}) {
    let shown = null;
    let since = -Infinity;
    let next = null;
    let waiting = false;
    const put = (text) => {
        if (text !== shown) {
            shown = text;
            since = now();
            show(text);
        }
    };
    return (text, atOnce = false) => {
        next = text;
        if (atOnce) {
            put(text);
            return;
        }
        const rest = since + SHOWN_MS - now();
        if (waiting) {
            return;
        }
        if (rest <= 0) {
            put(text);
        } else if (text !== shown) {
            waiting = true;
            later(() => {
                waiting = false;
                put(next);
            }, rest);
        }
    };
}
