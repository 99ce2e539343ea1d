/* Events within a page: who listens, and telling them. */

export function makeListeners() {
    const listeners = new Map();
    return {
        /* Calls listener(value) for each event of a name; returns a function that ends it. */
        on(name, listener) {
            if (!listeners.has(name)) {
                listeners.set(name, new Set());
            }
            listeners.get(name).add(listener);
            return () => listeners.get(name).delete(listener);
        },

        tell(name, value) {
            for (const listener of [...(listeners.get(name) ?? [])]) {
                try {
                    listener(value);
                } catch (error) {
                    console.error(error); /* one page in trouble does not stop the others */
                }
            }
        },
    };
}
