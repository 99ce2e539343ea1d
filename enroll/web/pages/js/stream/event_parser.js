/* Reads server-sent events (HTML standard, section 9.2) from pieces of text. It replaces the
 * browser's EventSource, which does not tell why a stream was refused. Pure. */

const MOST_CHARACTERS = 1 << 20;

export class EventParser {
    #rest = '';

    /* Takes text; returns the events that are complete now: [{name, data}, ...]. An event without a
     * name is a "message"; one without data is left out. */
    push(text) {
        this.#rest = (this.#rest + text).replace(/\r\n/g, '\n');
        if (this.#rest.length > MOST_CHARACTERS) {
            throw new RangeError('an event is too long');
        }
        const blocks = this.#rest.split('\n\n');
        this.#rest = blocks.pop();
        return blocks
            .map((block) => {
                const event = { name: 'message', data: [] };
                for (const line of block.split('\n')) {
                    const [, key, value] = /^([^:]*)(?:: ?(.*))?$/.exec(line) ?? [];
                    if (key === 'event') {
                        event.name = value ?? '';
                    } else if (key === 'data') {
                        event.data.push(value ?? '');
                    }
                }
                return { name: event.name, data: event.data.join('\n') };
            })
            .filter((event) => event.data !== '');
    }
}
