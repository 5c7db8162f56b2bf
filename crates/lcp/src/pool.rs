//! Vectors that are used again.

/// Vectors of one kind whose memory is free. Which one is taken never changes a result.
#[derive(Debug)]
pub struct Pool<T>(Vec<Vec<T>>);

impl<T> Default for Pool<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T> Pool<T> {
    /// An empty vector, with memory if there is any.
    pub fn take(&mut self) -> Vec<T> {
        self.0.pop().unwrap_or_default()
    }

    /// Takes a vector's memory for later use.
    pub fn give(&mut self, mut vector: Vec<T>) {
        if vector.capacity() > 0 {
            vector.clear();
            self.0.push(vector);
        }
    }

    /// Shares its vectors evenly with another.
    pub(crate) fn even_out(&mut self, other: &mut Self) {
        even_out(&mut self.0, &mut other.0);
    }
}

/// Moves the half of what one of two lists has more than the other.
pub(crate) fn even_out<T>(a: &mut Vec<T>, b: &mut Vec<T>) {
    let (more, fewer) = if a.len() > b.len() { (a, b) } else { (b, a) };
    let keeps = more.len() - (more.len() - fewer.len()) / 2;
    fewer.extend(more.drain(keeps..));
}

impl<T: Clone> Pool<T> {
    /// `len` times `value`.
    pub fn filled(&mut self, len: usize, value: T) -> Vec<T> {
        let mut vector = self.take();
        vector.resize(len, value);
        vector
    }
}
