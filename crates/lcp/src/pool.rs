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
}

impl<T: Clone> Pool<T> {
    /// `len` times `value`.
    pub fn filled(&mut self, len: usize, value: T) -> Vec<T> {
        let mut vector = self.take();
        vector.resize(len, value);
        vector
    }
}
