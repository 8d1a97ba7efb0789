/** A value that others watch. */
export class Signal<T> {
    private readonly watchers: ((value: T) => void)[] = [];

    constructor(private current: T) {}

    get value(): T {
        return this.current;
    }

    /** Sets the value; tells the watchers where it differs. */
    set(value: T): void {
        if (Object.is(value, this.current)) return;
        this.current = value;
        this.tell();
    }

    /** Tells the watchers although the reference is the same (its content changed). */
    tell(): void {
        for (const watcher of this.watchers) watcher(this.current);
    }

    /** Calls now and at each change. */
    watch(watcher: (value: T) => void): void {
        this.watchers.push(watcher);
        watcher(this.current);
    }
}
