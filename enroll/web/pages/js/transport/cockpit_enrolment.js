/* An enrolment over the bus: claim, start, signals, stop, release; and its state as the API
 * describes it (Enrolment in enroll/web/api/openapi.json). */

import {Fault} from './fault.js';

export class CockpitEnrolment {
    state = { state: 'none' };
    account = '';
    #bus;
    #listener = () => {};
    #signals = null;

    constructor(bus) { this.#bus = bus; }

    listen(listener) { this.#listener = listener; }

    #change(change) {
        this.state = {...this.state, ...change };
        this.#listener(this.state);
    }

    async #finish(change) {
        if (this.state.state !== 'running') {
            return;
        }
        this.#signals?.remove();
        this.#signals = null;
        this.#change({ state: 'ended', hint: '', ...change });
        /* Both at once: a page that is being closed cannot wait for the first answer. */
        const calls = ['EnrollStop', 'Release'].map((method) => this.#bus.call(method, []).catch(() => {}));
        await Promise.all(calls);
    }

    #receive(name, args) {
        if (name === 'EnrollStep') {
            const [pose, state, , , turn_deg] = args;
            const others = this.state.steps.filter((step) => step.pose !== pose);
            this.#change({ steps: [...others, { pose, state, turn_deg }], ...(state === 'turn' ? {} : { hint: '' }) });
        } else if (name === 'EnrollStatus') {
            const [result, done, stage, stages, quality, person] = args;
            const word = result.replace(/^enroll-/, '');
            if (done) {
                this.#finish({
                    result: word,
                    stage,
                    stages,
                    ...(word === 'duplicate' && { known_as: person }),
                    ...(word === 'not-stored' && { detail: person })
                });
            } else if (word.startsWith('retry-')) {
                this.#change({ hint: word.slice('retry-'.length) });
            } else {
                const captures = word === 'stage-passed' ? [...this.state.captures, quality] : this.state.captures;
                this.#change({ stage, stages, captures, hint: '' });
            }
        }
    }

    /* The consent is on record before anything is seen of the person: with the name of the account if
     * the user may call RecordAct, else by the daemon, with the user's number. */
    async begin(wish, record) {
        if (this.state.state === 'running') {
            throw new Fault('enrolment-running');
        }
        if (wish.consent !== true) {
            throw new Fault('consent-required');
        }
        if (record) {
            await this.#bus.call(
                'RecordAct',
                [this.account.toLowerCase().replace(/[^a-z0-9._-]/g, '-').slice(0, 32), 'consent', wish.person], 'sss');
        }
        await this.#bus.call('Claim', []);
        this.state = {
            state: 'running',
            person: wish.person,
            own: true,
            account: this.account,
            poses: wish.poses !== false,
            hint: '',
            stage: 0,
            stages: 0,
            captures: [],
            steps: []
        };
        this.#signals = this.#bus.subscribe((name, args) => this.#receive(name, args));
        try {
            await this.#bus.call(
                'EnrollStart',
                [wish.person, this.#bus.options({ poses: true, ...wish, consent: record ? undefined : true })],
                'sa{sv}');
        } catch (fault) {
            this.#signals?.remove();
            this.state = { state: 'none' };
            await this.#bus.call('Release', []).catch(() => {});
            throw fault;
        }
        this.#listener(this.state);
        return this.state;
    }

    /* Gives the camera back when the page goes away. The end of its connection would do this, too,
     * but a page that a browser keeps in its memory is still connected. */
    abandon() {
        if (this.state.state === 'running') {
            this.#finish({ result: 'left' });
        }
    }

    async end() {
        if (this.state.state !== 'running') {
            throw new Fault('no-enrolment');
        }
        await this.#finish({ result: 'stopped' });
    }
}
